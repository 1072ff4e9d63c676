"""A geared motor from its data sheet: torque and speed at the gear's shaft, current at the wires.

A data sheet's line torque = stall x (1 - speed / no-load speed) is kept exactly, with the dry friction that the current
without load tells; what back-EMF leaves of the slope is viscous friction.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from greywhale.arm.limits import DOUBTS, GUESSES

RAD_S_PER_RPM = math.tau / 60.0


@dataclass(frozen=True)
class DataSheet:
    """Values at `rated_v`; torque (N m) and speed (rad/s) at the joint, currents (A) at the wires."""

    rated_v: float
    gear_ratio: float
    stall_torque: float
    stall_current: float
    no_load_speed: float
    no_load_current: float
    rotor_inertia: float  # kg m², of the motor alone

    @property
    def slope(self) -> float:
        """N m s: torque lost for each rad/s."""
        return self.stall_torque / self.no_load_speed


def contradiction(stall_torque: float, stall_current: float, no_load_speed: float, rated_v: float) -> str:
    """The reason why no motor can have these values; "" where one can."""
    mechanical, electrical = stall_torque * no_load_speed, rated_v * stall_current
    if mechanical <= electrical:
        return ""
    return (
        f"stall torque x no-load speed is {mechanical:.3g} W, more than voltage x stall current = {electrical:.3g} W, "
        "which no motor can have; look at the units, and whether torque and speed are both those behind the gear"
    )


def tables(sheet: DataSheet) -> dict[str, dict[str, float]]:
    """`motor` and `friction` of an arm file's joint."""
    coulomb = sheet.stall_torque * sheet.no_load_current / sheet.stall_current
    per_volt = (sheet.stall_torque + coulomb) / sheet.rated_v
    ratio = sheet.gear_ratio
    at_joint = min((sheet.stall_torque + coulomb) / sheet.stall_current, DOUBTS.back_emf_share * sheet.slope / per_volt)
    viscous = sheet.slope - per_volt * at_joint
    return {
        "motor": {
            "inertia": sheet.rotor_inertia,
            "resistance": at_joint / per_volt,
            "torque_constant": at_joint / ratio,
            "viscous": viscous / ratio**2,
            "gear_ratio": ratio,
        },
        "friction": {"coulomb": coulomb, "breakaway": GUESSES.breakaway_ratio * coulomb},
    }
