"""The law by its definition, in rational arithmetic: slow, and easy to check by reading. It is the measure of all else.

Read it beside the paper: Eq. 16 is `error`, Eq. 17 `change`, Eq. 18 the sum in `Law.step`; Table 6 is in rules.py.
Units: radians, volts, seconds as fractions.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from greywhale.fuzzy.rules import OUTPUTS, RULES
from greywhale.fuzzy.settings import ANGLE_UNIT, GAIN_UNIT, KD_SPAN_MS, JointSettings

ZERO = Fraction(0)
ONE = Fraction(1)
LARGEST_DIFFERENCE = Fraction(32767, ANGLE_UNIT)  # rad: how far error and change of error go
INTEGRAL_END = Fraction(1 << 15, 1000)  # V: the integral stays within


class Feet(Enum):
    """The ends of a set: at 0, as the project reads the paper, or straight down at the end of the plateau."""

    AT_ZERO = "at zero"
    CRISP = "crisp"


def clamp(value: Fraction, limit: Fraction) -> Fraction:
    return max(-limit, min(limit, value))


def trapezoid(x: Fraction, a: Fraction, b: Fraction, c: Fraction, d: Fraction) -> Fraction:
    """1 from b to c, straight lines down to 0 at a and d; a = b or c = d is a step (1 on the step itself)."""
    if b <= x <= c:
        return ONE
    if a < x < b:
        return (x - a) / (b - a)
    if c < x < d:
        return (d - x) / (d - c)
    return ZERO


def fuzzify(
    x: Fraction, prefix: str, sets: tuple[Fraction, Fraction, Fraction, Fraction], feet: Feet
) -> dict[str, Fraction]:
    """Memberships of x in N, Z and P; `sets` are the end of N's plateau, Z's feet and the start of P's plateau."""
    n_c, z_a, z_c, p_b = sets
    n_d, p_a = (ZERO, ZERO) if feet is Feet.AT_ZERO else (n_c, p_b)
    return {
        "N" + prefix: trapezoid(x, -ONE, -ONE, n_c, n_d),
        "Z" + prefix: trapezoid(x, z_a, ZERO, ZERO, z_c),
        "P" + prefix: trapezoid(x, p_a, p_b, ONE, ONE),
    }


@dataclass(frozen=True)
class Inference:
    """Heights of the output sets, and their result u = (hP - hN) / (hN + hZ + hP), 0 when no rule fires."""

    heights: Mapping[str, Fraction]
    u: Fraction
    no_rule: bool


def infer(x: Fraction, y: Fraction, sets: Mapping[str, Fraction], feet: Feet = Feet.AT_ZERO) -> Inference:
    """AND is min, aggregation is max, the output sets are singletons weighted by their heights. x, y in [-1, 1]."""
    e = fuzzify(x, "E", (sets["ne_c"], sets["ze_a"], sets["ze_c"], sets["pe_b"]), feet)
    ce = fuzzify(y, "CE", (sets["nce_c"], sets["zce_a"], sets["zce_c"], sets["pce_b"]), feet)
    heights = dict.fromkeys(OUTPUTS, ZERO)
    for e_name, row in RULES.items():
        for ce_name, output in row.items():
            heights[output] = max(heights[output], min(e[e_name], ce[ce_name]))
    total = sum(heights.values(), ZERO)
    if total == 0:
        return Inference(heights, ZERO, no_rule=True)
    return Inference(heights, sum(OUTPUTS[name] * height for name, height in heights.items()) / total, no_rule=False)


@dataclass(frozen=True)
class State:
    """The law's memory: the errors of the last `ce_ticks` periods, the oldest first, and the integral in V."""

    errors: tuple[Fraction, ...] = ()
    integral: Fraction = ZERO


@dataclass(frozen=True)
class Output:
    u_fuzzy: Fraction
    volts: Fraction
    saturated: bool
    no_rule: bool
    wanted: Fraction  # volts before limit and anti-windup


@dataclass(frozen=True)
class Law:
    """One joint's settings, as stored, at a control period."""

    settings: JointSettings
    period_ms: int

    def inputs(self, error: Fraction, change: Fraction) -> tuple[Fraction, Fraction]:
        """x and y: the error and its change as the fuzzy sets get them."""
        kp = Fraction(self.settings.kp, GAIN_UNIT)
        kd = Fraction(self.settings.kd, GAIN_UNIT) * KD_SPAN_MS / (self.settings.ce_ticks * self.period_ms)
        return clamp(kp * error, ONE), clamp(kd * change, ONE)

    def infer(self, error: Fraction, change: Fraction) -> Inference:
        return infer(*self.inputs(error, change), self.settings.set_values())

    def step(self, state: State, leader: Fraction, follower: Fraction, limit: Fraction) -> tuple[Output, State]:
        """Compute one control period. The integral takes in the error, unless that leaves the output beyond the limit
        on the error's own side.
        """
        error = clamp(leader - follower, LARGEST_DIFFERENCE)
        full = len(state.errors) == self.settings.ce_ticks
        change = clamp(error - state.errors[0], LARGEST_DIFFERENCE) if full else ZERO
        inference = self.infer(error, change)
        proportional = Fraction(self.settings.ku_mv, 1000) * inference.u
        ki = Fraction(self.settings.ki, GAIN_UNIT)
        integral = clamp(state.integral + ki * Fraction(self.period_ms, 1000) * error, INTEGRAL_END)
        wanted = proportional + integral
        saturated = abs(wanted) > limit
        if saturated and (wanted < 0) == (error < 0):
            integral = state.integral
        output = Output(inference.u, clamp(proportional + integral, limit), saturated, inference.no_rule, wanted)
        return output, State((*state.errors[full:], error), integral)
