"""Motor drivers as their data sheets describe them: from the levels of their pins to what a motor's bridge does."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from greywhale._native import logarithm

PWM_S = 50e-6
# Inductance over resistance of a small geared motor, some 1 mH and 3 ohm: how long a current lasts in an open bridge.
ELECTRICAL_S = 0.3e-3


@dataclass(frozen=True)
class Pins:
    """The pins that the board drives: duties 0..1, levels. One that it does not drive is low: chips pull it down."""

    enable: bool
    pwm: float  # or the first of two PWM inputs
    direction: bool  # or IN1
    second_pwm: float = 0.0
    second_direction: bool = False  # IN2


@dataclass(frozen=True)
class Bridge:
    """The share of a PWM period in which it puts the supply on a motor, either way, and in which it shorts the motor,
    so that it brakes. The rest of the time the bridge is open, and the motor coasts.
    """

    forwards: float
    backwards: float
    shorted: float

    @cached_property
    def open(self) -> float:
        return max(0.0, 1.0 - self.forwards - self.backwards - self.shorted)

    @cached_property
    def drive(self) -> float:
        """Share of the supply on the motor, on the average."""
        return self.forwards - self.backwards

    @cached_property
    def duty(self) -> float:
        return max(self.forwards, self.backwards)


OPEN, SHORTED = Bridge(0.0, 0.0, 0.0), Bridge(0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Chip:
    """A motor driver: the board's parameter `driver` for its signals, and what it makes of them."""

    name: str
    sentence: str
    signals: int
    bridge: Callable[[Pins], Bridge]
    has_enable: bool = True


def sign_magnitude(pins: Pins) -> Bridge:
    if not pins.enable:
        return SHORTED
    forwards, backwards = (pins.pwm, 0.0) if pins.direction else (0.0, pins.pwm)
    return Bridge(forwards, backwards, 1.0 - pins.pwm)


def tb6612(pins: Pins) -> Bridge:
    if not pins.enable:  # STBY
        return OPEN
    if pins.direction == pins.second_direction:
        return SHORTED if pins.direction else OPEN
    return sign_magnitude(pins)


def l298n(pins: Pins) -> Bridge:
    """The PWM is its enable input: between pulses all its switches are off."""
    if pins.direction == pins.second_direction:
        return Bridge(0.0, 0.0, pins.pwm)
    return Bridge(pins.pwm, 0.0, 0.0) if pins.direction else Bridge(0.0, pins.pwm, 0.0)


def two_inputs(pins: Pins) -> Bridge:
    """Both inputs low opens the bridge, both high shorts it. Pulses of two timers meet by chance."""
    first, second = pins.pwm, pins.second_pwm
    return Bridge(first * (1.0 - second), second * (1.0 - first), first * second)


def drv8833(pins: Pins) -> Bridge:
    return two_inputs(pins) if pins.enable else OPEN  # nSLEEP


def half_bridges(pins: Pins) -> Bridge:
    """Two half-bridges: a low input connects its side to ground."""
    if not pins.enable:
        return OPEN
    bridge = two_inputs(pins)
    return Bridge(bridge.forwards, bridge.backwards, bridge.shorted + bridge.open)


def always_on(pins: Pins) -> Bridge:
    return half_bridges(replace(pins, enable=True))


CHIPS: Mapping[str, Chip] = {
    chip.name: chip
    for chip in (
        Chip("drv8838", "PWM and direction, with an enable input: DRV8838, Cytron's boards", 0, sign_magnitude),
        Chip("tb6612", "TB6612FNG: PWM, IN1 and IN2; brakes between pulses", 1, tb6612),
        Chip("l298n", "L298N: PWM at the enable input, IN1 and IN2; coasts between pulses", 1, l298n, has_enable=False),
        Chip("l298n-jumpers", "L298N with its enable jumpers on: two PWM inputs", 2, always_on, has_enable=False),
        Chip("drv8871", "DRV8871: two PWM inputs and no enable input", 2, two_inputs, has_enable=False),
        Chip("drv8833", "DRV8833: two PWM inputs", 2, drv8833),
        Chip(
            "bts7960", "BTS7960, IBT-2: two PWM inputs, each of a half-bridge; brakes between pulses", 2, half_bridges
        ),
    )
}


def mean_volts(bridge: Bridge, supply_v: float, emf_v: float) -> float:
    """The voltage that would drive the same mean current through a motor as this bridge does, V.

    With a bridge that is never open this is the mean voltage. In an open bridge the motor's inductance drives the
    current on, through diodes and against the supply, until it has died away; then no current flows.
    """
    if bridge.open < 1e-9:
        return supply_v * (bridge.forwards - bridge.backwards)
    driven = bridge.forwards - bridge.backwards
    if driven == 0.0 or supply_v == 0.0:
        return emf_v * bridge.open
    way = math.copysign(1.0, driven)
    return way * _pulsed(abs(driven), supply_v, way * emf_v)


def _pulsed(duty: float, supply: float, emf: float) -> float:
    """The mean for pulses one way and an open bridge between them; `emf` counts in the way of the pulses."""
    on = duty * PWM_S
    peak = (supply - emf) * _risen(on / ELECTRICAL_S)  # of the current, times the resistance
    against = math.copysign(supply, peak)
    final = -against - emf  # what an endless pause would lead to
    if peak * final >= 0.0:
        return duty * supply - (1.0 - duty) * against
    fall = ELECTRICAL_S * logarithm((peak - final) / -final)
    if fall >= PWM_S - on:  # the current never ends
        return duty * supply - (1.0 - duty) * against
    return emf + (supply * on - against * fall - emf * (on + fall)) / PWM_S


def _risen(x: float) -> float:
    """1 - exp(-x) up to PWM_S / ELECTRICAL_S by its series, which has the same bits with every C library."""
    rest = 1.0
    for n in range(12, 1, -1):
        rest = 1.0 - x / n * rest
    return x * rest
