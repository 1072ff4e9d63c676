"""The motor drivers' chips that a bench may have; sim/bench/drivers.h says what each makes of its pins."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from greywhale._native import DriverChip


@dataclass(frozen=True)
class Chip:
    """A motor driver: the board's parameter `driver` for its signals, and what it makes of them."""

    name: str
    sentence: str
    signals: int
    kind: DriverChip


CHIPS: Mapping[str, Chip] = {
    chip.name: chip
    for chip in (
        Chip(
            "drv8838",
            "PWM and direction, with an enable input: DRV8838, Cytron's boards",
            0,
            DriverChip.SIGN_MAGNITUDE,
        ),
        Chip("tb6612", "TB6612FNG: PWM, IN1 and IN2; brakes between pulses", 1, DriverChip.TB6612),
        Chip("l298n", "L298N: PWM at the enable input, IN1 and IN2; coasts between pulses", 1, DriverChip.L298N),
        Chip("l298n-jumpers", "L298N with its enable jumpers on: two PWM inputs", 2, DriverChip.ALWAYS_ON),
        Chip("drv8871", "DRV8871: two PWM inputs and no enable input", 2, DriverChip.TWO_INPUTS),
        Chip("drv8833", "DRV8833: two PWM inputs", 2, DriverChip.TWO_INPUTS_NSLEEP),
        Chip(
            "bts7960",
            "BTS7960, IBT-2: two PWM inputs, each of a half-bridge; brakes between pulses",
            2,
            DriverChip.HALF_BRIDGES,
        ),
    )
}
