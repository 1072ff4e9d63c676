"""The board's `stall_volts` for an identified arm: more than any joint needs to start, less than a blocked one gets.

A joint that stands under more voltage is stalled (docs/firmware.md). Too low a limit takes a heavy joint at rest for a
blocked one; too high a limit lets a joint with a frozen potentiometer creep on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypedDict

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.holding import starting_volts
from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.types import Floats, PerJoint
from greywhale.identify import sampled_plants
from greywhale.protocol import schema
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import ParameterTable, physical

STALL_VOLTS = schema.PARAMETER_BY_NAME["stall_volts"]
SAMPLES, SEED = 64, 0
DEVIATIONS = 3.0  # of what the model leaves open
LEAST_MARGIN = 0.25  # of the need: friction differs from place to place, and from day to day
LEAST_V = 1.6  # voltages below this start a joint so slowly that it may not be seen to move in time
MOST_OF_SUPPLY = 0.8  # a blocked joint's integral part goes to the supply, and the limit must lie below that


class StallFacts(TypedDict):
    stall_volts: float  # the board's limit, V
    needs_v: PerJoint[float]  # to start where gravity pulls most
    deviation_v: PerJoint[float]  # standard deviation


@dataclass(frozen=True)
class StallLimit:
    """`raw` as the board stores it. `needs` and their standard `deviations` are the joints', in V."""

    raw: int
    needs: tuple[float, ...]
    deviations: tuple[float, ...]
    note: str = ""  # what speaks against the limit

    @property
    def volts(self) -> float:
        return physical(STALL_VOLTS, self.raw)

    @property
    def joint(self) -> int:
        """The joint that asks for most."""
        return int(np.argmax(_limits(np.array(self.needs), np.array(self.deviations))))

    @property
    def sentence(self) -> str:
        """The limit and where it comes from, for people."""
        joint = self.joint
        return (
            f"stall_volts {self.volts:g} V: joint {joint} ({JOINT_NAMES[joint]}) needs {self.needs[joint]:.1f} V "
            f"(± {self.deviations[joint]:.1g}) to start where gravity pulls most."
        )

    def as_dict(self) -> StallFacts:
        return {
            "stall_volts": self.volts,
            "needs_v": [round(value, 3) for value in self.needs],
            "deviation_v": [round(value, 3) for value in self.deviations],
        }


def stall_limit(arm: ArmParameters, table: ParameterTable, samples: int = SAMPLES) -> StallLimit | None:
    """The limit for an identified arm on the board of `table`.

    None where the board's check is off, which stays so. The arm needs a covariance; with one sample its numbers are
    taken as exact, and it needs none.
    """
    if table["stall_volts"] == 0:
        return None
    low, high = _range(arm, table)
    volts = np.array([starting_volts(plant, low, high) for plant in sampled_plants(arm, samples, SEED)])
    needs, deviations = volts[0], np.sqrt(np.sum((volts - volts[0]) ** 2, axis=0) / max(samples - 1, 1))
    wanted = float(np.max(_limits(needs, deviations)))
    most = min(MOST_OF_SUPPLY * table.supply_v, STALL_VOLTS.to_physical(STALL_VOLTS.maximum))
    raw = math.ceil(min(max(wanted, LEAST_V), most) / STALL_VOLTS.lsb - 1e-9)
    note = ""
    if wanted > most:
        joint = int(np.argmax(_limits(needs, deviations)))
        note = (
            f"joint {joint} ({JOINT_NAMES[joint]}) needs {needs[joint]:.1f} V to start where gravity pulls most, but "
            f"stall_volts can be {most:g} V at most: it may count as stalled there; take a stronger motor, more gear, "
            "or narrower limits."
        )
    return StallLimit(raw, tuple(map(float, needs)), tuple(map(float, deviations)), note)


def _limits(needs: Floats, deviations: Floats) -> Floats:
    """What each joint asks for, V."""
    return needs + np.maximum(LEAST_MARGIN * needs, DEVIATIONS * deviations)


def _range(arm: ArmParameters, table: ParameterTable) -> tuple[Floats, Floats]:
    """Where the joints may stand: between the board's limits, within the stops."""
    limit = schema.PARAMETER_BY_NAME["joint0.limit_min"]
    low, high = (
        np.array([limit.to_physical(raw) for raw in table.each("joint", f"limit_{end}")]) for end in ("min", "max")
    )
    stops = [arm.joint[joint].stops for joint in range(JOINTS)]
    low = np.maximum(low, [one.min for one in stops])
    high = np.maximum(low, np.minimum(high, [one.max for one in stops]))
    used = np.isin(np.arange(JOINTS), arm.joints_in_use)
    return np.where(used, low, 0.0), np.where(used, high, 0.0)
