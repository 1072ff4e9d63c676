"""The arm and its potentiometers, which move and measure; C++ (sim/arm) does the work."""

from __future__ import annotations

from greywhale import _native
from greywhale.arm.parameters import ArmParameters, PotentiometerBank

LONGEST_STEP_S = 0.25e-3  # of the integrator


class Arm(_native.Arm):
    """The follower arm: `step(voltages, dt)` holds four voltages (V) for dt seconds; it returns the joint angles (rad).

    The same parameters, seed and inputs give the same motion. The seed draws where in its backlash each gear stands
    after a reset.
    """

    def __init__(self, parameters: ArmParameters, seed: int = 0, longest_step_s: float = LONGEST_STEP_S) -> None:
        super().__init__(parameters.native(), seed, longest_step_s)
        self.parameters = parameters


class Potentiometers(_native.Potentiometers):
    """The four potentiometers of one arm: `millivolts(angles)`, or `counts(angles)` through a 10-bit converter."""

    def __init__(self, bank: PotentiometerBank, seed: int = 0) -> None:
        super().__init__(native_potentiometers(bank), bank.supply, seed)
        self.bank = bank


def native_potentiometers(bank: PotentiometerBank, noise: bool = True) -> list[_native.Potentiometer]:
    """The four potentiometers for the native code, on request without noise."""
    quiet = {} if noise else {"noise": 0.0}
    return [_native.Potentiometer(**(dict(pot) | quiet)) for pot in bank.joint]
