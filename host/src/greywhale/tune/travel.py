"""The travel of each joint of an identified arm under a voltage: by it the board holds back a joint that stands.

A joint that has had more voltage than holds it, for longer than it takes to move it, is held back (docs/firmware.md).
Too low a breakaway voltage holds back a joint that only sticks; too high a one lets a joint with a frozen potentiometer
creep on. What a joint carries beyond its model the board finds out itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypedDict

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.body import Body
from greywhale.arm.parameters import JOINT_NAMES
from greywhale.arm.plants import columns, rigid_joints
from greywhale.base.types import Floats, PerJoint
from greywhale.identify import sampled_plants
from greywhale.protocol import schema
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import ParameterTable
from greywhale.tune.limits import TUNING_LIMITS, TravelLimits

SAMPLES, SEED = 64, 0  # of the plants; more would only take longer
GRAVITY = ("gravity_1", "gravity_12", "gravity_2")


class TravelFacts(TypedDict):
    speed_per_volt: PerJoint[float]  # rad/(s V)
    time_constant_ms: PerJoint[float]
    breakaway_v: PerJoint[float]  # V beyond those against gravity
    gravity_v: dict[str, float]  # V, with the arm held level


@dataclass(frozen=True)
class Travel:
    """Physical values, (4,) each, of the joints; `gravity` (3,) in V by the names in GRAVITY."""

    speed_per_volt: tuple[float, ...]
    time_constant_ms: tuple[float, ...]
    breakaway_v: tuple[float, ...]
    gravity_v: tuple[float, ...]
    note: str = ""  # what speaks against a limit

    def raw(self) -> dict[str, int]:
        """Parameter name -> raw value, within what the board takes."""
        names = {
            f"joint{joint}.{key}": values[joint]
            for key, values in (
                ("speed_per_volt", self.speed_per_volt),
                ("time_constant", self.time_constant_ms),
                ("breakaway_volts", self.breakaway_v),
            )
            for joint in range(JOINTS)
        } | dict(zip(GRAVITY, self.gravity_v, strict=True))
        found = {}
        for name, value in names.items():
            parameter = schema.PARAMETER_BY_NAME[name]
            found[name] = min(max(round(value / parameter.lsb), parameter.minimum), parameter.maximum)
        return found

    @property
    def sentence(self) -> str:
        """For people: from which voltage on the board expects each joint to move."""
        volts = ", ".join(f"{volts:.1f}" for volts in self.breakaway_v)
        return (
            f"breakaway voltages {volts} V: with more, beyond what gravity asks for, a joint must move or is held back."
        )

    def as_dict(self) -> TravelFacts:
        def rounded(values: tuple[float, ...]) -> list[float]:
            return [round(value, 3) for value in values]

        return {
            "speed_per_volt": rounded(self.speed_per_volt),
            "time_constant_ms": rounded(self.time_constant_ms),
            "breakaway_v": rounded(self.breakaway_v),
            "gravity_v": dict(zip(GRAVITY, rounded(self.gravity_v), strict=True)),
        }


def travel_of(
    arm: ArmParameters,
    table: ParameterTable,
    samples: int = SAMPLES,
    limits: TravelLimits = TUNING_LIMITS.travel,
) -> Travel | None:
    """The numbers of an identified arm for the board of `table`; None where the board's check is off, which stays so.

    The arm needs a covariance; with one sample its numbers are taken as exact, and it needs none.
    """
    if table["stall_volts"] == 0:
        return None
    plants = sampled_plants(arm, samples, SEED)
    used = ~rigid_joints(plants[0])
    friction, gravity = _each(plants, "breakaway") / _torque_per_volt(plants), _gravity_volts(plants)
    friction = friction + np.maximum(_each(plants, "lost_up"), _each(plants, "lost_down"))
    spread = friction + np.abs(gravity - gravity[0])
    deviation = np.sqrt(np.sum((spread - spread[0]) ** 2, axis=0) / max(samples - 1, 1))
    wanted = friction[0] + np.maximum(limits.least_margin * friction[0], limits.sigmas * deviation)
    most = limits.max_supply_share * table.supply_v
    damping, per_volt = _each(plants, "damping")[0], _torque_per_volt(plants)[0]
    inertia = _each(plants, "inertia")[0] + np.diagonal(Body.of(plants[0]).mass_matrix(np.zeros((1, JOINTS)))[0])
    return Travel(
        speed_per_volt=_tuple(np.divide(per_volt, damping, out=_kept(table, "speed_per_volt"), where=used)),
        time_constant_ms=_tuple(np.divide(1000.0 * inertia, damping, out=_kept(table, "time_constant"), where=used)),
        breakaway_v=_tuple(np.where(used, np.clip(wanted, limits.least_v, most), _kept(table, "breakaway_volts"))),
        gravity_v=_tuple(_level_volts(plants[0])),
        note=_note(wanted, most),
    )


def _kept(table: ParameterTable, name: str) -> Floats:
    """(4,) What the board has for each joint; those that are not in use keep it."""
    return np.array([table.physical(f"joint{joint}.{name}") for joint in range(JOINTS)])


def _note(wanted: Floats, most: float) -> str:
    joint = int(np.argmax(wanted))
    if wanted[joint] <= most:
        return ""
    return (
        f"joint {joint} ({JOINT_NAMES[joint]}) needs {wanted[joint]:.1f} V to move, but its breakaway_volts can be "
        f"{most:g} V at most: it may be held back where it is only heavy; take a stronger motor, more gear, or "
        "narrower limits."
    )


def _level_volts(plant: Floats) -> Floats:
    """(3,) V by the names in GRAVITY: what holds the arm level, in the form of the board's cosines."""
    poses = np.zeros((2, JOINTS))
    poses[1, 2] = 0.5 * math.pi  # what joint 2 carries hangs above it, and pulls at nothing
    level, upright = Body.of(plant).bias(poses, np.zeros_like(poses))
    first, second = _torque_per_volt(plant)[1:3]
    return np.array([upright[1] / first, (level[1] - upright[1]) / first, level[2] / second])


def _gravity_volts(plants: Floats) -> Floats:
    """(n, 4) V that hold each joint where gravity pulls most."""
    level = np.array([_level_volts(plant) for plant in plants])
    return np.column_stack([np.zeros(len(plants)), level[:, 0] + level[:, 1], level[:, 2], np.zeros(len(plants))])


def _torque_per_volt(plants: Floats) -> Floats:
    """(n, 4) or (4,) N m/V; of a joint that is not in use infinite, because no voltage is needed to hold it."""
    return np.where(rigid_joints(plants), np.inf, plants[..., columns("torque_per_volt")])


def _each(plants: Floats, name: str) -> Floats:
    """(n, 4)"""
    return plants[:, columns(name)]


def _tuple(values: Floats) -> tuple[float, ...]:
    return tuple(map(float, values))
