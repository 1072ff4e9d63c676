"""Every reading of the paper's controllers on its own grey box, judged the same way.

What is open: where the sets end (feet), whether the change of error is a difference or a rate, the control period, the
length of a step's record, and friction. The law is in plain floats (`errata.Law`), the leader jumps, sensors are exact.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from greywhale.arm.plants import column, plant_row
from greywhale.base.types import Floats
from greywhale.files.arm import load_arm
from greywhale.files.trajectory import Trajectory
from greywhale.loop import multi_steps, steps
from greywhale.protocol.firmware import JOINTS
from greywhale.tune.judge.floor import saturation_floor
from greywhale_paper.work import errata
from greywhale_paper.work.arms import STICKY
from greywhale_paper.work.errata import SUPPLY_V, Law, follow, total_mse
from greywhale_paper.work.motions import PERIOD_MS, WAIT_S, printed

# Name -> crisp, rate.
LAWS = {
    "feet at 0, ce(k) = e(k) - e(k-1)": (False, False),
    "feet at 0, ce = de/dt": (False, True),
    "crisp feet, ce(k) = e(k) - e(k-1)": (True, False),
    "crisp feet, ce = de/dt": (True, True),
}
ARMS = {"no friction": "grey_box", "the friction of Table 11": STICKY}
PERIODS_MS = (PERIOD_MS, 1)
LENGTHS_S = (4.0, 9.0, 10.0, 19.0)  # of a step's record, from the step on
STEP_RAD, SMALL_STEP_RAD, SMALL_STEP_S = 1.0, 0.5, 10.0
TABLES = ("before_tuning", "table_10")
PLANE = 201  # points a side


@dataclass(frozen=True)
class Reading:
    """One way to read the paper; its names are keys of the dictionaries above."""

    law: str
    friction: str
    period_ms: int

    @property
    def key(self) -> str:
        return f"reading {self.law}, {self.friction}, {self.period_ms} ms"


READINGS = tuple(Reading(law, friction, period) for friction, period, law in itertools.product(ARMS, PERIODS_MS, LAWS))


def judge_reading(seed: int, law: str, friction: str, period_ms: int) -> dict[str, Any]:
    """Total MSE (rad²) of both controllers on steps (a record of each length) and multi-steps. `seed` draws nothing."""

    def errors(rows: Law, levels: tuple[float, ...], hold_s: float) -> Floats:
        return follow(ARMS[friction], frozenset(), rows, levels, hold_s, period_ms)

    found: dict[str, Any] = {}
    for table in TABLES:
        rows = Law.of(printed(table), *LAWS[law])
        step = errors(rows, (STEP_RAD,), max(LENGTHS_S))
        found[table] = {
            "steps": [total_mse(step[: round(length / errata.STEP_S)]) for length in LENGTHS_S],
            "small step": total_mse(errors(rows, (SMALL_STEP_RAD,), SMALL_STEP_S)),
            "multi-steps": total_mse(errors(rows, errata.LEVELS, errata.HOLD_S)),
        }
    return found


def silent(seed: int) -> dict[str, list[float]]:
    """With crisp feet: the share of the plane of both inputs, from -1 to 1, on which no rule of a joint fires."""
    axis = np.linspace(-1.0, 1.0, PLANE)
    x, y = (np.repeat(one.ravel()[:, None], JOINTS, axis=1) for one in np.meshgrid(axis, axis))
    found = {}
    for table in TABLES:
        law = Law.of(printed(table), crisp=True)
        shares: list[float] = replace(law, gains=np.ones_like(law.gains)).fuzzy(x, y)[1].mean(axis=0).tolist()
        found[table] = shares
    return found


def floors(seed: int) -> dict[str, Any]:
    """The least total error (rad² s, integrated) that any controller could reach, for each friction and motion."""
    # The multi-step of `errata`, whose first level is where it begins.
    staircase = multi_steps(list(errata.LEVELS), [errata.HOLD_S] * len(errata.LEVELS))
    found: dict[str, Any] = {}
    for friction, arm in ARMS.items():
        plant = plant_row(load_arm(arm)).copy()
        plant[column("supply")] = SUPPLY_V
        found[friction] = {
            "steps": _integral(steps(STEP_RAD, 1.0, min(LENGTHS_S)), plant),
            "small step": _integral(steps(SMALL_STEP_RAD, 1.0, min(LENGTHS_S)), plant),
            "multi-steps": _integral(staircase, plant),
        }
    return found


def _integral(motion: Trajectory, plant: Floats) -> float:
    """The floor is a mean over the whole of a motion; before its first edge, and at rest, it adds nothing."""
    return saturation_floor(motion, plant, wait_s=WAIT_S, threads=1).total * (WAIT_S + motion.duration_s)
