"""Screens the numbers by which a tuning judges, for those that change what it finds by more than chance does.

Three groups of tunings an arm. In `numbers` every plain number is at half or twice its distance from where it would do
nothing. In `rules` each rule that a number can switch off is on or off. In `chance` only the seed differs. Every tuning
works on a model identified once, and is judged on the true arm (MuJoCo's as our own engine has it), by motions that
nothing was trained on. What is told from chance on one arm is left as usual on the next. Runs, effects and errors are
left in build/ablation. GREYWHALE_ARMS names other arms, as for `commission`; GREYWHALE_BUDGET is a tuning's budget
(300).
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.limits import BY_DEFINITION, Limit, limits_in
from greywhale.base.study import Task
from greywhale.base.types import Floats
from greywhale.cli.story.practice import practise, tables
from greywhale.files.arm import default_arm, load_arm
from greywhale.identify import identify
from greywhale.loop import plant_row
from greywhale.protocol.table import ParameterTable
from greywhale.tune import tune
from greywhale.tune.judge.held_out import HeldOut, judge_held_out
from greywhale.tune.judge.margins import AT_REST, MOVING, Margins
from greywhale.tune.limits import WITHOUT_FLOORS, TuningLimits
from greywhale.tune.model import load_model
from tools import ROOT
from tools.benchmarks.bench_commission import bench_with, traits_of
from tools.benchmarks.figure import Figure
from tools.benchmarks.study import repeat
from tools.support.foreign_arm import foreign_arm_with
from tools.support.recordings import worn_arm
from tools.support.screening import Levels, effects, screen, standard_error

FOLDER = ROOT / "build" / "ablation"
ARMS = os.environ.get("GREYWHALE_ARMS", "default 1,worn 11,mujoco 2").split(",")
BUDGET = int(os.environ.get("GREYWHALE_BUDGET", "300"))
SAMPLES = 1  # the estimate alone, beside the arm with looser gears
SEEDS = range(100, 108)
TOLD = 2.0  # standard errors, from which on an effect is more than chance
MOVED_RAD2 = 1e-5  # a joint with a smaller error hardly moved

Groups = dict[str, dict[str, tuple[Any, Any]]]  # by group and name: the lower and the upper value
Told = dict[str, dict[str, dict[str, float]]]  # by name and response: effect and errors

GROUPS = ("training", "space", "cost", "floor", "margins", "choice", "following")
# Read by a report or an upload, by a refusal, or by a commissioning only: no tuning's result depends on these.
APART = (
    "training.least_range_rad",
    "floor.backlash_rad2",
    "floor.tellable_rad2",
    "floor.rest_s",
    "floor.rest_rad",
    "floor.waiting_rad",
    "floor.waiting_rad_s",
    "choice.unrest_weight_on_arm",
    "choice.worse_in_report",
    "following.follows_worse",
    "following.unseen_rad",
)
FACTORS = (0.5, 2.0)
# A rest is longer than what is left out of it.
CLOSER: dict[str, tuple[Any, Any]] = {"margins.settle_s": (0.5, 1.4), "margins.rest_s": (1.6, 4.4)}
RATIO = 1.5  # a factor below this is one beyond 1, and 1 does nothing
USUAL = WITHOUT_FLOORS
# What switches a rule off.
OFF: dict[str, Any] = {
    "model.gear_sigmas": 0.0,
    **dict.fromkeys(("cost.rms_weight", "cost.rattle_weight", "cost.louder_weight", "cost.chatter_weight"), 0.0),
    **dict.fromkeys(("cost.shaking_weight", "cost.effort_weight", "cost.worst_plant_share"), 0.0),
    "cost.least_room_share": 0.0,
    "cost.bearable_share": 1.0,
    "floor.tried_brakes": (1.0,),
    "margins.teeth_damping_divisor": 1.0,
    "margins.long_rest_s": USUAL.margins.rest_s,
    **dict.fromkeys(("margins.search_beyond", "margins.search_ripple_share"), 1.0),
    **dict.fromkeys(("margins.travel_price", "margins.fail_price"), 0.0),
    **dict.fromkeys(("margins.teeth_price", "margins.ripple_price", "margins.loud_price"), 0.0),
    "choice.kept_joint_slack": USUAL.choice.joint_slack,
    "choice.second_chances": 0,
    "choice.gain_reductions": (),
    "choice.same_ripple": 1.0,
    "choice.shaken_ripple": USUAL.choice.same_ripple,
    "following.behind_price": 0.0,
}


def numbers() -> dict[str, tuple[Any, Any]]:
    """By name: the lower and the upper value of every number that is screened."""
    return {one.name: _levels_of(one) for one in limits_in(USUAL) if _is_screened(one)} | CLOSER


def _is_screened(one: Limit) -> bool:
    number = isinstance(one.value, int | float) and one.origin != BY_DEFINITION
    return number and one.name.split(".")[0] in GROUPS and one.name not in APART


def _levels_of(one: Limit) -> tuple[Any, Any]:
    """Half and twice the value, of what it is beyond 1 where it is a factor; a share comes only half as near to 1."""
    lower, upper = (factor * one.value for factor in FACTORS)
    if isinstance(one.value, int):
        return max(1, round(lower)), round(upper)
    if one.unit.startswith("times") and 1.0 < one.value < RATIO:
        lower, upper = (1.0 + factor * (one.value - 1.0) for factor in FACTORS)
    elif one.name.endswith("_share") and upper >= 1.0:
        upper = 1.0 - 0.5 * (1.0 - one.value)
    return lower, upper


def rules() -> dict[str, tuple[Any, Any]]:
    """By name: the value that switches a rule off, and the usual one."""
    return {name: (off, usual(name)) for name, off in OFF.items()}


def usual(name: str) -> Any:
    """The value of a limit by its dotted name."""
    group, inner = name.split(".")
    return getattr(getattr(USUAL, group), inner)


def with_values(limits: TuningLimits, values: Mapping[str, Any]) -> TuningLimits:
    """The limits with others by their dotted names."""
    for name, value in values.items():
        group, inner = name.split(".")
        limits = replace(limits, **{group: replace(getattr(limits, group), **{inner: value})})
    return limits


def true_arm(kind: str, seed: int) -> ArmParameters:
    """The arm that was recorded; MuJoCo's without what our engine does not have."""
    if kind == "default":
        return default_arm()
    if kind == "worn":
        return worn_arm(seed)
    foreign = foreign_arm_with(seed, traits_of(kind))
    data = foreign.parameters.model_dump()
    for pot, play in zip(data["follower_pots"]["joint"], foreign.play, strict=True):
        pot["play"] = float(play)
    return ArmParameters.model_validate(data, strict=False)


def model_of(kind: str, number: int) -> Path:
    """The model file of an arm, identified from practice on its bench where there is none yet."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{kind}_{number}.toml"
    if not path.exists():
        base, white = ParameterTable.defaults(), load_arm("white_box")
        with tempfile.TemporaryDirectory() as name, bench_with(kind, number, Path(name)) as bench:
            logs = practise(bench, white, base, Path(name)).logs
        outcome = identify([logs[0]], white, validate=logs[1:], tables=tables(base))
        if not outcome.complete:
            raise KeyboardInterrupt
        outcome.save(path)
    return path


def tuned(seed: int, kind: str, number: int, budget: int, values: Mapping[str, Any]) -> dict[str, float]:
    """The responses of a tuning with these values of limits, all of which are better the smaller they are."""
    limits = with_values(USUAL, values)
    model = load_model(model_of(kind, number), samples=SAMPLES, force=True, judging=limits)
    found = tune(model, budget=budget, seed=seed, threads=1, judging=limits)
    if not found.complete:
        raise KeyboardInterrupt
    arm, judge = _judge(kind, number)
    held_out = judge_held_out(arm, model.table, plant_row(arm), found.before, found.after, 1, USUAL)
    margins = judge.check(found.after)
    rest = [one for one in margins if one.scenario == AT_REST]
    return {
        "error": float(np.mean([np.log(one.after.total_mse / one.before.total_mse) for one in held_out])),
        "worst joint": max(float(_ratios(one).max()) for one in held_out),
        "ripple": float(np.log(max(one.ripple_v for one in rest))),
        "rattle": float(np.log(max(one.rattle_rad for one in margins if one.scenario == MOVING))),
        "unrest": float(sum(not one.holds for one in margins)),
    }


@cache
def _judge(kind: str, number: int) -> tuple[ArmParameters, Margins]:
    arm = true_arm(kind, number)
    return arm, Margins(arm, ParameterTable.defaults(), plant_row(arm)[None], threads=1)


def _ratios(one: HeldOut) -> Floats:
    """Logarithms of a joint's error after to before, of those that moved."""
    moved = one.mse_before > MOVED_RAD2
    ratios: Floats = np.log(one.mse_after[moved] / one.mse_before[moved])
    return ratios


def tasks_of(arm: str, groups: Groups) -> Iterator[Task]:
    """The tunings of one arm."""
    kind, number = arm.split()
    common: dict[str, Any] = {"kind": kind, "number": int(number), "budget": BUDGET}
    for seed in SEEDS:
        yield Task(f"chance {seed}", tuned, seed, common | {"values": {}})
    for group, levels in groups.items():
        for run, row in enumerate(screen(len(levels))):
            values = {name: pair[int(level > 0)] for (name, pair), level in zip(levels.items(), row, strict=True)}
            yield Task(f"{group} {run}", tuned, run, common | {"values": values})


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
    left: Groups = {"rules": rules(), "numbers": numbers()}
    most: dict[str, dict[str, tuple[float, str]]] = {group: {} for group in left}
    for arm in ARMS:
        model_of(arm.split()[0], int(arm.split()[1]))
        found = repeat(f"ablation {arm}", list(tasks_of(arm, left)))
        effect = {group: told(found, group, levels) for group, levels in left.items()}
        text = json.dumps({"runs": found, "effects": effect}, indent=1)
        (FOLDER / f"{arm}.json").write_text(text + "\n", encoding="utf-8")
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
            Figure(f"ablation, {group}: {name}, {where}", value, "errors") for name, (value, where) in each_most.items()
        ]
        figures.append(Figure(f"ablation: {group} within chance, of {len(each_most)}", len(left[group]), ""))
    return figures
