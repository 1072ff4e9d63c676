"""The firmware's arithmetic, bit for bit, over numpy arrays: the integer twin of firmware/lib/fuzzy_pdi.

It follows compile.cpp, arithmetic.h, inference.h and fuzzy_pdi.cpp function for function; docs/fuzzy.md has the
formats.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from greywhale.fuzzy.settings import KD_SPAN_MS, JointSettings

Ints = NDArray[np.int64]

ONE = (1 << 24) - 1  # membership 1.0
LARGEST_SLOPE = (1 << 32) - 1
INTEGRAL_END = 1 << 46  # 2^-31 mV

_RECIPROCALS = np.array([131072 // (257 + i) for i in range(256)], dtype=np.int64)


@dataclass(frozen=True)
class Side:
    """Slopes on one side of one input, and how many bits finer each is: 0, 8 for a short ramp, 1 for a medium one."""

    zero: int
    outer: int
    zero_shift: int
    outer_shift: int

    @property
    def short_ramps(self) -> int:
        """The short ramps as the bits of `ShortRamp` in fuzzy_pdi.h."""
        bits = {0: 0, 8: 0x81, 1: 0x84}[self.zero_shift]
        return bits | (0x82 if self.outer_shift else 0)


@dataclass(frozen=True)
class Coefficients:
    """Sides [positive, negative] of e and ce, the integral's step in 2^-31 mV and Ku."""

    e: tuple[Side, Side]
    ce: tuple[Side, Side]
    integral: int
    ku_mv: int
    ce_ticks: int


def _slope(width: int, gain: int, shift: int) -> int:
    part, divisor = ONE * 4 * gain, width << shift
    return min((2 * part + divisor) // (2 * divisor), LARGEST_SLOPE)


def _is_full_within(sizes: int, width: int, gain: int) -> bool:
    """For 128 and 256 sizes: whether a slope of 32 bits is too short for a ramp that is full so early."""
    return (ONE * 4 * gain) >> 32 >= width * (256 // sizes)


def _without_low_byte(slope: int) -> int:
    if slope < 1 << 24:
        return slope
    return min(slope + 128, LARGEST_SLOPE) & ~0xFF


def _side(zero_width: int, outer_width: int, gain: int) -> Side:
    zero = 8 if _is_full_within(128, zero_width, gain) else 1 if _is_full_within(256, zero_width, gain) else 0
    outer = 8 if _is_full_within(256, outer_width, gain) else 0
    slopes = _slope(zero_width, gain, zero), _without_low_byte(_slope(outer_width, gain, outer))
    return Side(*slopes, zero, outer)


def compile_settings(s: JointSettings, period_ms: int) -> Coefficients:
    """The coefficients that the firmware derives from settings it does not refuse."""
    kd, span_ms = s.kd * KD_SPAN_MS, s.ce_ticks * period_ms
    return Coefficients(
        e=(_side(s.ze_c, s.pe_b, s.kp), _side(-s.ze_a, -s.ne_c, s.kp)),
        ce=(
            _side(s.zce_c * span_ms, s.pce_b * span_ms, kd),
            _side(-s.zce_a * span_ms, -s.nce_c * span_ms, kd),
        ),
        integral=(s.ki * period_ms) << 3,
        ku_mv=s.ku_mv,
        ce_ticks=s.ce_ticks,
    )


def _climb(slope: int, shift: int, size: Ints) -> Ints:
    height: Ints = np.minimum(((size << shift) * slope + 32768) >> 16, ONE)
    return np.where(size > 255, ONE, height) if shift == 8 else height


def _fuzzify(sides: tuple[Side, Side], value: Ints) -> tuple[Ints, Ints]:
    size = np.abs(value)
    zero = [_climb(side.zero, side.zero_shift, size) for side in sides]
    outer = [_climb(side.outer, side.outer_shift, size) for side in sides]
    return ONE - np.where(value < 0, zero[1], zero[0]), np.where(value < 0, outer[1], outer[0])


def ratio_q15(part: Ints, whole: Ints) -> Ints:
    """2^15 * part / whole for part <= whole and 2^16 <= whole < 2^26."""
    down = np.where(whole >> 25, 2, np.where(whole >> 24, 1, 0))
    part, whole = part >> down, whole >> down
    up = 24 - np.frexp(whole.astype(np.float64))[1].astype(np.int64)  # 2^(exponent-1) <= whole < 2^exponent
    part, whole = part << up, whole << up

    r = _RECIPROCALS[(whole >> 15) & 255]
    rest = (0xFFFFFFFF - whole * r) >> 9
    series = rest + (((rest >> 8) * (rest >> 8)) >> 7)
    first = (part * r) >> 8
    high, low = first >> 16, (first >> 8) & 255
    more = high * (series >> 8) + ((high * (series & 255)) >> 8) + ((low * (series >> 8)) >> 8)
    quotient: Ints = (((first + 2 * more) >> 8) + 1) >> 1
    return quotient


@dataclass(frozen=True)
class Inference:
    """Every intermediate: heights, rules seen from e's side, magnitude of u_fuzzy in q15 and its sign."""

    e_zero: Ints
    e_outer: Ints
    ce_zero: Ints
    ce_outer: Ints
    with_e: Ints
    zero: Ints
    against_e: Ints
    size: Ints
    flip: NDArray[np.bool_]
    no_rule: NDArray[np.bool_]
    u: Ints  # with its sign


def infer(c: Coefficients, e: ArrayLike, ce: ArrayLike) -> Inference:
    """The inference for errors and changes of error in 1/4096 rad."""
    e, ce = np.broadcast_arrays(np.asarray(e, np.int64), np.asarray(ce, np.int64))
    a, big_a = _fuzzify(c.e, e)
    b, big_b = _fuzzify(c.ce, ce)
    same = (e < 0) == (ce < 0)
    with_e = np.where(
        same,
        np.maximum(np.minimum(a, big_b), np.minimum(big_a, np.maximum(b, big_b))),
        np.minimum(big_a, b),
    )
    zero = np.where(same, np.minimum(a, b), np.maximum(np.minimum(a, b), np.minimum(big_a, big_b)))
    against = np.where(same, 0, np.minimum(a, big_b))

    whole = with_e + zero + against
    no_rule = whole < 65536
    size = np.where(no_rule, 0, ratio_q15(np.abs(with_e - against), np.where(no_rule, 65536, whole)))
    flip = (against > with_e) & ~no_rule
    u = np.where((e < 0) != flip, -size, size)
    return Inference(a, big_a, b, big_b, with_e, zero, against, size, flip, no_rule, u)


@dataclass(frozen=True)
class Run:
    """A trajectory: per period u_fuzzy (q15), volts (mV), flags, and the integral in 2^-31 mV."""

    u_fuzzy: Ints
    volts_mv: Ints
    saturated: NDArray[np.bool_]
    no_rule: NDArray[np.bool_]
    integral: list[int]


def _difference(a: Ints, b: Ints) -> Ints:
    difference: Ints = np.clip(a - b, -32767, 32767)
    return difference


class Controller:
    """The law of one joint with its memory."""

    def __init__(self, settings: JointSettings, period_ms: int) -> None:
        self.coefficients = compile_settings(settings, period_ms)
        self.reset()

    def reset(self) -> None:
        self.integral = 0  # 2^-31 mV
        self.errors = np.empty(0, np.int64)  # of the last `ce_ticks` periods

    def run(self, leader: ArrayLike, follower: ArrayLike, limit_mv: ArrayLike) -> Run:
        """One period after another; only the integral cannot be vectorised."""
        c = self.coefficients
        error = _difference(np.asarray(leader, np.int64), np.asarray(follower, np.int64))
        known = np.concatenate([self.errors, error])
        self.errors = known[-c.ce_ticks :]
        change = _difference(known[c.ce_ticks :], known[: -c.ce_ticks])
        inference = infer(c, error, np.concatenate([np.zeros(len(error) - len(change), np.int64), change]))
        limits = np.broadcast_to(np.asarray(limit_mv, np.int64), error.shape)
        drive = inference.u * c.ku_mv

        volts, saturated, integral = [], [], []
        for e, proportional, limit in zip(error.tolist(), drive.tolist(), limits.tolist(), strict=True):
            taken = min(max(self.integral + e * c.integral, -INTEGRAL_END), INTEGRAL_END - 1)
            millivolts, down = _volts(proportional, taken)
            saturated.append(millivolts > limit)
            if millivolts > limit and down == (e < 0):
                taken = self.integral
                millivolts, down = _volts(proportional, taken)
            self.integral = taken
            integral.append(taken)
            volts.append(-min(millivolts, limit) if down else min(millivolts, limit))
        return Run(
            np.clip(inference.u, -32767, 32767),
            np.array(volts, np.int64),
            np.array(saturated, np.bool_),
            inference.no_rule,
            integral,
        )


def _volts(proportional: int, integral: int) -> tuple[int, bool]:
    """Size in mV, rounded half away from zero, and whether it is negative."""
    total = proportional + (integral >> 16)
    return (2 * abs(total) + 0x8000) >> 16, total < 0
