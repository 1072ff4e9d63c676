"""Measures an identification that starts from the white box, on arms that it never saw: how far the model is from the
default arm and ten random ones, and how often its 90 % intervals hold the truth.

The constants of the intervals come from arms 1 to 12, so the intervals are counted on others. GREYWHALE_ARMS says on
how many (7).
"""

from __future__ import annotations

import os
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.study import Task
from greywhale.files.arm import default_arm, load_arm
from greywhale.identify import IdentificationResult, identify
from greywhale.identify.closed_loop import Loop
from greywhale.identify.space import KINDS, Parameter, Space
from greywhale.loop import plant_row
from greywhale.protocol.table import ParameterTable
from tools.benchmarks.figure import Figure, at_least, at_most
from tools.benchmarks.study import repeat
from tools.support.recordings import Recorded, random_arm, record_three, table_of

ARMS = range(1, 11)
OTHERS = 13  # the first of them
HALF = 1.6449  # deviations of a normal distribution that hold 90 %
NAMES = ("before_tuning", "table_10")


def tables() -> list[ParameterTable]:
    return [table_of(name) for name in NAMES]


def identified(recorded: Recorded) -> tuple[IdentificationResult, float]:
    begin = time.perf_counter()
    outcome = identify(
        [recorded.fit], load_arm("white_box"), validate=[recorded.second, recorded.changed], tables=tables()
    )
    if not outcome.complete:
        raise KeyboardInterrupt
    return outcome, time.perf_counter() - begin


def of_arm(arm: ArmParameters, seed: int) -> tuple[IdentificationResult, float]:
    with tempfile.TemporaryDirectory() as folder:
        return identified(record_three(arm, Path(folder), seed))


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
    return [
        at_least("default arm: better than white box, set 2", gains[1], "%", 97),
        at_least("default arm: the same, changed controller", gains[2], "%", 90),
        at_most("identification of a 30 s log", seconds, "s", 30),
        *distances(arms[: len(ARMS)]),
        *coverage([one["held"] for one in arms[len(ARMS) :]]),
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


def coverage(found: list[dict[str, list[bool]]]) -> list[Figure]:
    by_kind: dict[str, list[bool]] = {"all": []}
    for verdicts in found:
        for kind, here in verdicts.items():
            by_kind.setdefault(kind, []).extend(here)
            by_kind["all"].extend(here)
    return [share(kind, here) for kind, here in by_kind.items() if here]


def share(kind: str, held_here: list[bool]) -> Figure:
    part = 100.0 * sum(held_here) / len(held_here)
    return Figure(f"90 % intervals that hold, {kind}, of {len(held_here)}", part, "%", "85 .. 95", 85.0 <= part <= 95.0)
