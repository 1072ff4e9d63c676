"""Measures an identification that starts from the white box, on arms that it never saw: how far the model is from the
default arm and ten random ones, and how often its 90 % intervals hold the truth; the same on arms that MuJoCo moves.

The constants of the intervals come from arms 1 to 12, so the intervals are counted on others. GREYWHALE_ARMS says on
how many (7), GREYWHALE_FOREIGN how many arms are MuJoCo's (10).
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.bench_process import RunningBench
from greywhale.base.study import Task
from greywhale.cli.story import record_motion
from greywhale.cli.story.practice import OTHER, UNTUNED
from greywhale.cli.story.recorder import StoppedError
from greywhale.files.arm import default_arm, load_arm
from greywhale.files.leader import save_leader
from greywhale.files.log import Log
from greywhale.files.paper_tables import paper_table
from greywhale.identify import IdentificationResult, identify
from greywhale.identify.closed_loop import Loop
from greywhale.identify.space import KINDS, Parameter, Space
from greywhale.loop import human_reaches, plant_row
from tools.benchmarks.figure import Figure, at_least, at_most
from tools.benchmarks.study import repeat
from tools.support.foreign_arm import ForeignArm, bench_of, foreign_arm
from tools.support.recordings import random_arm, record_three, table_of

ARMS = range(1, 11)
OTHERS = 13  # the first of them
HALF = 1.6449  # deviations of a normal distribution that hold 90 %
NAMES = ("before_tuning", "table_10")
FOREIGN = int(os.environ.get("GREYWHALE_FOREIGN", "10"))
LOG_S = 30.0
COMMON = ("alpha", "inertia", "damping", "coulomb", "play")  # numbers that mean the same in MuJoCo


def identified(fit: Log, validate: Sequence[Log]) -> tuple[IdentificationResult, float]:
    begin = time.perf_counter()
    tables = [table_of(name) for name in (*NAMES, OTHER)]
    outcome = identify([fit], load_arm("white_box"), validate=validate, tables=tables)
    if not outcome.complete:
        raise KeyboardInterrupt
    return outcome, time.perf_counter() - begin


def of_arm(arm: ArmParameters, seed: int) -> tuple[IdentificationResult, float]:
    with tempfile.TemporaryDirectory() as folder:
        recorded = record_three(arm, Path(folder), seed)
        return identified(recorded.fit, [recorded.second, recorded.changed])


def truth(outcome: IdentificationResult, arm: ArmParameters) -> float:
    """The true arm's own figures on the changed record: where joints hunt, no model repeats every swing."""
    subject, verdict = outcome.subjects[2], outcome.verdicts[2]
    assert subject.table is not None
    loop = Loop(subject.log, subject.table, outcome.white_box)
    return 1.0 - float(loop.error(plant_row(arm)[None]).sum()) / sum(verdict.white_box)


def of_random_arm(seed: int) -> dict[str, Any]:
    """The gains of the model and of the true arm over the white box, the time it took, and which intervals hold."""
    arm = random_arm(seed)
    outcome, seconds = of_arm(arm, seed)
    second, changed = (verdict.improvement for verdict in outcome.verdicts[1:3])
    return {
        "second": second,
        "changed": changed,
        "true arm": truth(outcome, arm),
        "seconds": seconds,
        "held": held(outcome, arm),
    }


def held(outcome: IdentificationResult, arm: ArmParameters) -> dict[str, list[bool]]:
    """By kind of number: whether each interval of this arm holds the truth."""
    verdicts: dict[str, list[bool]] = {}
    for one in outcome.estimates:
        if one.deviation is None:
            continue
        parameter = Parameter.from_name(one.name)
        kind = KINDS[parameter.kind]
        off = kind.to_search(one.value) - true_number(arm, parameter)
        width = one.deviation / one.value if kind.logarithmic else one.deviation
        verdicts.setdefault(parameter.kind, []).append(abs(off) <= HALF * width)
    return verdicts


def of_foreign_arm(seed: int) -> dict[str, Any]:
    """The gains and the error of the model of an arm of another engine on our bench, and which intervals hold."""
    foreign = foreign_arm(seed)
    with tempfile.TemporaryDirectory() as name, bench_of(foreign, Path(name)) as bench:
        logs = recorded_on(bench, Path(name), 10 * seed)
        outcome, seconds = identified(logs[0], logs[1:])
    second, *changed = outcome.verdicts[1:]
    return {
        "second": second.improvement,
        "changed": [verdict.improvement for verdict in changed],
        "second mrad": 1e3 * float(np.sqrt(np.mean(second.model))),
        "seconds": seconds,
        "held": {kind: here for kind, here in held(outcome, with_play(foreign)).items() if kind in COMMON},
    }


def recorded_on(bench: RunningBench, folder: Path, seed: int) -> list[Log]:
    """As `record_three`, through the serial port of a bench; without the last where the board stops the arm in it."""
    logs = []
    for number, name in enumerate((UNTUNED, UNTUNED, OTHER)):
        leader = folder / f"leader {number}.csv"
        save_leader(leader, human_reaches(seed + number + 1, LOG_S))
        with suppress(*(StoppedError,) if name == OTHER else ()):
            logs.append(record_motion(bench, leader, folder / f"{number}.csv", paper_table(name)).log())
    return logs


def with_play(foreign: ForeignArm) -> ArmParameters:
    """Its parameters and the play between its joints and potentiometers, in our model's words."""
    data = foreign.parameters.model_dump()
    for pot, play in zip(data["follower_pots"]["joint"], foreign.play, strict=True):
        pot["play"] = 0.5 * float(play)
    return ArmParameters.model_validate(data, strict=False)


def true_number(arm: ArmParameters, parameter: Parameter) -> float:
    """The searched number of this arm; 0 of wear that it does not have."""
    return float(Space.of(arm, (parameter.kind,), (parameter.joint,)).start()[0]) if has(arm, parameter) else 0.0


def has(arm: ArmParameters, parameter: Parameter) -> bool:
    """False for wear that this arm does not have."""
    if parameter.kind == "sag":
        return arm.drive.supply_resistance > 0.0
    joint, pot = arm.joint[parameter.joint], arm.follower_pots.joint[parameter.joint]
    wear = {
        "play": pot.play,
        "lag": pot.lag,
        "load": joint.friction.load,
        "creep": joint.friction.creep_velocity,
        "lost": joint.driver.lost_up + joint.driver.lost_down,
        "uneven": abs(joint.driver.lost_up - joint.driver.lost_down),
    }
    return wear.get(parameter.kind, 1.0) > 0.0


def run() -> list[Figure]:
    others = range(OTHERS, OTHERS + int(os.environ.get("GREYWHALE_ARMS", "7")))
    outcome, seconds = of_arm(default_arm(), 1)
    gains = [100 * verdict.improvement for verdict in outcome.verdicts]
    found = repeat("identify", [Task(f"random arm {seed}", of_random_arm, seed) for seed in (*ARMS, *others)])
    arms = list(found.values())
    foreign = list(
        repeat(
            "identify foreign", [Task(f"foreign arm {seed}", of_foreign_arm, seed) for seed in range(1, 1 + FOREIGN)]
        ).values()
    )
    return [
        at_least("default arm: better than white box, set 2", gains[1], "%", 97),
        at_least("default arm: the same, changed controller", gains[2], "%", 90),
        at_most("identification of a 30 s log", seconds, "s", 30),
        *distances(arms[: len(ARMS)]),
        *coverage([one["held"] for one in arms[len(ARMS) :]]),
        *of_another_engine(foreign),
    ]


def of_another_engine(found: list[dict[str, Any]]) -> list[Figure]:
    """Their play sits between joint and potentiometer, their friction is softer than ours and has no Stribeck part."""
    if not found:
        return []
    head = f"{len(found)} arms of MuJoCo"
    second = [100 * one["second"] for one in found]
    changed = [100 * gain for one in found for gain in one["changed"]]
    return [
        at_least(f"{head}: set 2, median", float(np.median(second)), "%", 97),
        at_least(f"{head}: set 2, least", min(second), "%", 90),
        Figure(f"{head}: set 2, rms error, median", float(np.median([one["second mrad"] for one in found])), "mrad"),
        at_least(f"{head}: changed controller, median", float(np.median(changed)), "%", 90),
        *coverage([one["held"] for one in found], f"{head}: "),
    ]


def distances(found: list[dict[str, Any]]) -> list[Figure]:
    second, changed, ceiling = ([100 * one[key] for one in found] for key in ("second", "changed", "true arm"))
    head = f"{len(found)} random arms"
    return [
        at_least(f"{head}: set 2, median", float(np.median(second)), "%", 97),
        at_least(f"{head}: set 2, least", min(second), "%", 90),
        at_least(f"{head}: changed controller, median", float(np.median(changed)), "%", 90),
        Figure(f"{head}: the same of the true arms", float(np.median(ceiling)), "%"),
        at_most(f"{head}: slowest", max(one["seconds"] for one in found), "s", 30),
    ]


def coverage(found: list[dict[str, list[bool]]], head: str = "") -> list[Figure]:
    by_kind: dict[str, list[bool]] = {"all": []}
    for verdicts in found:
        for kind, here in verdicts.items():
            by_kind.setdefault(kind, []).extend(here)
            by_kind["all"].extend(here)
    return [share(f"{head}90 % intervals that hold, {kind}", here) for kind, here in by_kind.items() if here]


def share(name: str, held_here: list[bool]) -> Figure:
    part = 100.0 * sum(held_here) / len(held_here)
    return Figure(f"{name}, of {len(held_here)}", part, "%", "85 .. 95", 85.0 <= part <= 95.0)
