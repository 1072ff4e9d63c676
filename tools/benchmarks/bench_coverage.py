"""Counts how often the stated 90 % intervals hold the truth, on random arms identified from 30 s of their motion.

The constants of the intervals come from arms 1 to 12, so these are others. GREYWHALE_ARMS says how many (100); each
takes most of a minute of one processor.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from greywhale.arm import ArmParameters
from greywhale.base.study import Task
from greywhale.files.arm import load_arm
from greywhale.identify import identify
from greywhale.identify.space import KINDS, Parameter, Space
from tools.benchmarks.bench_identify import tables
from tools.benchmarks.figure import Figure
from tools.benchmarks.study import repeat
from tools.support.recordings import random_arm, record_three

FIRST = 13
ARMS = int(os.environ.get("GREYWHALE_ARMS", "100"))
HALF = 1.6449  # deviations of a normal distribution that hold 90 %


def held(seed: int) -> dict[str, list[bool]]:
    """By kind of number: whether each interval of this arm holds the truth."""
    arm = random_arm(seed)
    with tempfile.TemporaryDirectory() as folder:
        recorded = record_three(arm, Path(folder), seed)
        found = identify([recorded.fit], load_arm("white_box"), tables=tables())
    verdicts: dict[str, list[bool]] = {}
    for one in found.estimates:
        if one.deviation is None:
            continue
        parameter = Parameter.from_name(one.name)
        space = Space.of(arm, (parameter.kind,), (parameter.joint,))
        kind, truth = KINDS[parameter.kind], float(space.start()[0])
        off = kind.to_search(one.value) - truth
        width = one.deviation / one.value if kind.logarithmic else one.deviation
        verdicts.setdefault(parameter.kind, []).append(has(arm, parameter) and abs(off) <= HALF * width)
    return verdicts


def has(arm: ArmParameters, parameter: Parameter) -> bool:
    """False for wear that this arm does not have; no interval of it can hold the truth."""
    if parameter.kind == "sag":
        return arm.drive.supply_resistance > 0.0
    joint, pot = arm.joint[parameter.joint], arm.follower_pots.joint[parameter.joint]
    wear = {
        "play": pot.play,
        "lag": pot.lag,
        "load": joint.friction.load,
        "creep": joint.friction.creep_velocity,
    }
    return wear.get(parameter.kind, 1.0) > 0.0


def run() -> list[Figure]:
    found = repeat("coverage", [Task(f"random arm {seed}", held, seed) for seed in range(FIRST, FIRST + ARMS)])
    by_kind: dict[str, list[bool]] = {}
    for verdicts in found.values():
        for kind, here in verdicts.items():
            by_kind.setdefault(kind, []).extend(here)
    everything = [one for here in by_kind.values() for one in here]
    return [
        share("all", everything),
        *(share(kind, here) for kind, here in by_kind.items()),
    ]


def share(kind: str, held_here: list[bool]) -> Figure:
    part = 100.0 * sum(held_here) / len(held_here)
    return Figure(f"90 % intervals that hold, {kind}, of {len(held_here)}", part, "%", "85 .. 95", 85.0 <= part <= 95.0)
