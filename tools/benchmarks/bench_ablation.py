"""Screens the numbers by which a room judges, for those that change what it finds by more than chance does.

GREYWHALE_ROOM says which room: tune, identify, or commission. Three groups of runs an arm. In `numbers` every plain
number is at half or twice its distance from where it would do nothing. In `rules` each rule that a number can switch
off is on or off. In `chance` only the seed differs. Every run is judged on the true arm (MuJoCo's as our own engine has
it), by motions that it has not seen. What is told from chance on one arm is left as usual on the next. Runs, effects
and errors are left in build/ablation. GREYWHALE_ARMS names other arms, as for `commission`; GREYWHALE_GROUPS=rules
leaves out the numbers; GREYWHALE_BUDGET is a tuning's budget (300).
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from greywhale.base.study import Task
from tools.benchmarks.ablated import FOLDER, Ablated
from tools.benchmarks.ablated_commission import COMMISSION
from tools.benchmarks.ablated_identify import IDENTIFY
from tools.benchmarks.ablated_tune import TUNE
from tools.benchmarks.figure import Figure
from tools.benchmarks.study import repeat
from tools.support.screening import Levels, effects, screen, standard_error

ROOMS = {"tune": TUNE, "identify": IDENTIFY, "commission": COMMISSION}
ROOM = os.environ.get("GREYWHALE_ROOM", "tune")
ARMS = os.environ.get("GREYWHALE_ARMS", "default 1,worn 11,mujoco 2").split(",")
CHOSEN = os.environ.get("GREYWHALE_GROUPS", "rules,numbers").split(",")
SEEDS = range(100, 108)
TOLD = 2.0  # standard errors, from which on an effect is more than chance

Groups = dict[str, dict[str, tuple[Any, Any]]]  # by group and name: the lower and the upper value
Told = dict[str, dict[str, dict[str, float]]]  # by name and response: effect and errors


def tasks_of(room: Ablated, arm: str, groups: Groups) -> Iterator[Task]:
    """The runs on one arm."""
    kind, number = arm.split()
    common: dict[str, Any] = {"kind": kind, "number": int(number), **room.options}
    for seed in SEEDS:
        yield Task(f"chance {seed}", room.measure, seed, common | {"values": {}})
    for group, levels in groups.items():
        for run, row in enumerate(screen(len(levels))):
            values = {name: pair[int(level > 0)] for (name, pair), level in zip(levels.items(), row, strict=True)}
            yield Task(f"{group} {run}", room.measure, run, common | {"values": values})


def told(found: Mapping[str, Mapping[str, float]], group: str, levels: Mapping[str, Any]) -> Told:
    """By name and response: the effect of going from the lower to the upper value, in itself and in standard errors."""
    design: Levels = screen(len(levels))
    result: Told = {name: {} for name in levels}
    for response in next(iter(found.values())):
        rows = np.array([found[f"{group} {run}"][response] for run in range(len(design))])
        by_seed = np.array([found[f"chance {seed}"][response] for seed in SEEDS])
        sizes = effects(design, rows)
        error = standard_error(sizes, len(design), by_seed)
        for name, size in zip(levels, sizes, strict=True):
            result[name][response] = {"effect": float(size), "errors": float(size / error) if error else 0.0}
    return result


def run() -> list[Figure]:
    room = ROOMS[ROOM]
    left: Groups = {group: getattr(room, group)() for group in CHOSEN}
    FOLDER.mkdir(parents=True, exist_ok=True)
    most: dict[str, dict[str, tuple[float, str]]] = {group: {} for group in left}
    for arm in ARMS:
        kind, number = arm.split()
        room.prepare(kind, int(number))
        found = repeat(f"ablation {ROOM} {arm}", list(tasks_of(room, arm, left)))
        effect = {group: told(found, group, levels) for group, levels in left.items()}
        text = json.dumps({"runs": found, "effects": effect}, indent=1)
        (FOLDER / f"{ROOM} {arm}.json").write_text(text + "\n", encoding="utf-8")
        for group, each in effect.items():
            for name, responses in each.items():
                response, one = max(responses.items(), key=lambda pair: abs(pair[1]["errors"]))
                new = (one["errors"], f"{response} of {arm}")
                most[group][name] = max(most[group].get(name, new), new, key=lambda pair: abs(pair[0]))
        # What is told on one arm stays as usual on the next ones, which so are told apart more finely.
        left = {
            group: {name: pair for name, pair in levels.items() if abs(most[group][name][0]) < TOLD}
            for group, levels in left.items()
        }
    figures = []
    for group, each_most in most.items():
        figures += [
            Figure(f"ablation {ROOM}, {group}: {name}, {where}", value, "errors")
            for name, (value, where) in each_most.items()
        ]
        figures.append(Figure(f"ablation {ROOM}: {group} within chance, of {len(each_most)}", len(left[group]), ""))
    return figures
