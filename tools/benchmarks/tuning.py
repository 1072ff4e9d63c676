"""Shared by the benchmarks of the tuning: the motions to judge it on, and figures from measures before and after."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.types import Floats
from greywhale.cli.story.practice import CHECK_SHARE, PRACTICE_S, START_POSE_RAD, tables
from greywhale.files.arm import load_arm
from greywhale.files.log import Log
from greywhale.files.trajectory import Trajectory
from greywhale.identify.excite import design
from greywhale.identify.excite.design import GOOD_BUDGET
from greywhale.loop import human_reaches, multi_steps, steps
from greywhale.measure import Evaluation
from greywhale.protocol.table import ParameterTable
from greywhale.tune.judge.floor import saturation_floor
from tools.benchmarks.figure import Figure, at_most
from tools.support.recordings import record

LOWER = 78.0  # %, of the total MSE
OF_FLOOR = 1.15
STEADY_RAD = 0.02
# Delays are read off logs with a row a millisecond.
SAME_DELAY_S = 0.001
# How late the board hears of the leader: the mean age of a tick's conversions, the low-pass, and half a tick of hold.
LATE_S = 0.5e-3 + 1e-3 + 0.5e-3
# Below this (rad^2) a floor is no floor: the motion never asks for more than the supply gives.
SATURATED = 1e-4


def motions() -> dict[str, Trajectory]:
    """Motions that nothing was trained on."""
    return {"steps": steps(), "multi-steps": multi_steps(), "human reaches": human_reaches(1, 20.0)}


def practised(arm: ArmParameters, folder: Path, seed: int) -> list[Log]:
    """The logs of a demonstration's practice, made by the native loop: one to fit, two to validate."""
    # All that is known of any arm is the white box, so all practise the same motion.
    known = tables(ParameterTable.defaults())
    logs = [record(arm, excitation(), folder / "practice.csv", known[0], 10 * seed)]
    for number, table in enumerate(known, 1):
        motion = human_reaches(10 * seed + number, CHECK_SHARE * PRACTICE_S)
        logs.append(record(arm, motion, folder / f"{table.name}.csv", table, 10 * seed + number))
    return logs


@cache
def excitation() -> Trajectory:
    """The motion that shows most about an arm of which only the white box is known."""
    return design(load_arm("white_box"), START_POSE_RAD, seconds=PRACTICE_S, budget=GOOD_BUDGET).motion


@dataclass(frozen=True)
class Judged:
    """One motion before and after tuning; `floor` is the least MSE (4,) that any controller could reach."""

    name: str
    before: Evaluation
    after: Evaluation
    floor: Floats
    late_floor: Floats | None = None  # the same where a controller hears of the leader as late as the board does

    @classmethod
    def of(cls, name: str, motion: Trajectory, arm: ArmParameters, before: Evaluation, after: Evaluation) -> Judged:
        floor, late = (saturation_floor(motion, arm, resample=True, delay_s=delay).mse for delay in (0.0, LATE_S))
        return cls(name, before, after, floor, late)

    @property
    def lower(self) -> float:
        """By how much the total MSE fell, %."""
        return 100.0 * (1.0 - self.after.total_mse / self.before.total_mse)

    @property
    def of_floor(self) -> float | None:
        """The total MSE as a multiple of the floor, where there is one."""
        total = float(self.floor.sum())
        return self.after.total_mse / total if total > SATURATED else None

    def mse_ratios(self) -> Floats:
        """After to before, of every joint that moved enough to tell: a joint at rest shows noise only."""
        pairs = zip(self.after.joints, self.before.joints, strict=True)
        return np.array([after.mse / before.mse for after, before in pairs if before.mse > 1e-5])

    def steady(self) -> float | None:
        """The largest steady-state error of a joint, rad."""
        errors = [joint.steady_state_error for joint in self.after.joints if joint.steady_state_error is not None]
        return max(errors, default=None)

    def later(self, which: str) -> float | None:
        """By how much the delay of a joint grew most, s; negative where all got shorter."""
        grown = []
        for before, after in zip(self.before.joints, self.after.joints, strict=True):
            a, b = getattr(before, which), getattr(after, which)
            if a is not None and b is not None:
                grown.append(b - a)
        return max(grown, default=None)


def figures(where: str, judged: Mapping[str, Judged]) -> list[Figure]:
    """The project's bars, motion by motion."""
    found: list[Figure] = []
    for name, one in judged.items():
        head = f"{where}, {name}"
        found.append(Figure(f"{head}: total MSE before", one.before.total_mse, "rad2"))
        found.append(Figure(f"{head}: total MSE after", one.after.total_mse, "rad2"))
        found += _reached(head, name, one)
        worst = float(one.mse_ratios().max())
        found.append(at_most(f"{head}: MSE of the worst joint, after / before", worst, "x", 1.0))
        steady = one.steady()
        if steady is not None:
            found.append(at_most(f"{head}: largest steady-state error", steady, "rad", STEADY_RAD))
        for which, means in (("delay_s", "delay"), ("onset_delay_s", "onset delay")):
            later = one.later(which)
            if later is not None:
                holds = later <= SAME_DELAY_S
                found.append(Figure(f"{head}: {means}, most grown", 1e3 * later, "ms", "<= 0 (+1)", holds))
    return found


def _reached(head: str, name: str, one: Judged) -> list[Figure]:
    lower, multiple = one.lower, one.of_floor
    if name == "steps":
        assert multiple is not None
        either = lower >= LOWER or multiple <= OF_FLOOR
        return [
            Figure(f"{head}: MSE lower by", lower, "%", f">= {LOWER:g}, or", either),
            Figure(f"{head}: MSE over the floor", multiple, "x", f"<= {OF_FLOOR}", either),
            Figure(f"{head}: MSE before over the floor", one.before.total_mse / float(one.floor.sum()), "x"),
            *_late(head, one),
        ]
    found = [Figure(f"{head}: MSE lower by", lower, "%")]
    if multiple is None:
        return found
    return [*found, Figure(f"{head}: MSE over the floor", multiple, "x"), *_late(head, one)]


def _late(head: str, one: Judged) -> list[Figure]:
    if one.late_floor is None:
        return []
    late = one.after.total_mse / float(one.late_floor.sum())
    return [Figure(f"{head}: MSE over the floor of a controller {1e3 * LATE_S:g} ms late", late, "x")]
