"""The closed loop of four joints as one writes it in numba: closed form, scalar code, one candidate after the other.

1 ms steps with implicit damping, Coulomb friction with stiction, rigid gears, 10-bit sensors, the fuzzy law in floating
point. That is less work than greywhale's own loop, which has backlash and the firmware's integers.
"""

from __future__ import annotations

import math

import numba  # type: ignore[import-not-found,unused-ignore]
import numpy as np

from greywhale.base.types import Floats

DT = 1e-3


@numba.njit(fastmath=True)  # type: ignore[untyped-decorator,unused-ignore]
def fuzzy(x: float, y: float) -> float:
    """Three by three sets at +-0.5, height-weighted singletons."""
    ne, pe = min(1.0, max(0.0, -2.0 * x)), min(1.0, max(0.0, 2.0 * x))
    nc, pc = min(1.0, max(0.0, -2.0 * y)), min(1.0, max(0.0, 2.0 * y))
    ze, zc = max(0.0, 1.0 - 2.0 * abs(x)), max(0.0, 1.0 - 2.0 * abs(y))
    negative = max(min(ne, nc), min(ne, zc), min(ze, nc))
    positive = max(min(pe, pc), min(pe, zc), min(ze, pc))
    zero = max(min(ze, zc), min(ne, pc), min(pe, nc))
    return (positive - negative) / (negative + zero + positive)


@numba.njit(fastmath=True)  # type: ignore[untyped-decorator,unused-ignore]
def loop(p: Floats, gains: Floats, leader: Floats) -> float:
    """One candidate: a row of greywhale.loop.PLANT_COLUMNS, (4, 4) gains kp kd ki ku, leader (ticks, 4)."""
    q, v, u = np.zeros(4), np.zeros(4), np.zeros(4)
    before, integral = np.zeros(4), np.zeros(4)
    h, total = p[8], 0.0
    right, diagonal = np.zeros(4), np.zeros(4)
    for k in range(leader.shape[0]):
        for i in range(4):
            e = leader[k, i] - q[i]
            total += e * e
            seen = (math.floor((q[i] / 5.235987755982989 + 0.5) * 1024.0) / 1024.0 - 0.5) * 5.235987755982989
            e = leader[k, i] - seen
            x = min(1.0, max(-1.0, gains[i, 0] * e))
            y = min(1.0, max(-1.0, 20.0 * gains[i, 1] * (e - before[i])))
            before[i] = e
            want = gains[i, 3] * fuzzy(x, y) + gains[i, 2] * (integral[i] + DT * e)
            if abs(want) < 15.0:
                integral[i] += DT * e
            u[i] = min(15.0, max(-15.0, want))
        s1, c1, s2, c2 = math.sin(q[1]), math.cos(q[1]), math.sin(q[2]), math.cos(q[2])
        sp, cp = s1 * c2 + c1 * s2, c1 * c2 - s1 * s2
        m00 = p[0] + p[1] * s1 * s1 + p[2] * c1 * c1 + p[3] * sp * sp + p[4] * cp * cp + 2 * h * c1 * cp
        m03, m33, m22, m12, m11 = p[6] * sp, p[6], p[5], p[5] + h * c2, p[7] + p[5] + 2 * h * c2
        across = (p[3] - p[4]) * 2 * sp * cp
        d1 = (p[1] - p[2]) * 2 * s1 * c1 + across - 2 * h * (s1 * cp + c1 * sp)
        d2 = across - 2 * h * c1 * sp
        roll, w = p[6] * cp, v[1] + v[2]
        right[0] = -((d1 * v[1] + d2 * v[2]) * v[0] + roll * w * v[3])
        right[1] = (
            0.5 * d1 * v[0] ** 2 + h * s2 * v[2] * (2 * v[1] + v[2]) + roll * v[0] * v[3] - p[9] * c1 - p[10] * cp
        )
        right[2] = 0.5 * d2 * v[0] ** 2 - h * s2 * v[1] ** 2 + roll * v[0] * v[3] - p[10] * cp
        right[3] = -roll * v[0] * w
        diagonal[0], diagonal[1], diagonal[2], diagonal[3] = m00, m11, m22, m33
        for i in range(4):
            o = 11 + 12 * i
            push = right[i] + p[o] * u[i] + (p[o + 1] + diagonal[i]) * v[i] / DT
            push = math.copysign(max(0.0, abs(push) - p[o + 3]), push)
            right[i] = DT * push
            diagonal[i] += p[o + 1] + DT * p[o + 2]
        right[0] += m03 * v[3]
        right[3] += m03 * v[0]
        right[1] += m12 * v[2]
        right[2] += m12 * v[1]
        a, b = diagonal[0] * diagonal[3] - m03 * m03, diagonal[1] * diagonal[2] - m12 * m12
        v[0], v[3] = (diagonal[3] * right[0] - m03 * right[3]) / a, (diagonal[0] * right[3] - m03 * right[0]) / a
        v[1], v[2] = (diagonal[2] * right[1] - m12 * right[2]) / b, (diagonal[1] * right[2] - m12 * right[1]) / b
        for i in range(4):
            q[i] = min(2.55, max(-2.55, q[i] + DT * v[i]))
    mean: float = total / leader.shape[0]
    return mean


@numba.njit  # type: ignore[untyped-decorator,unused-ignore]
def batch(plants: Floats, gains: Floats, leader: Floats) -> Floats:
    """Every candidate's mean squared error."""
    out = np.zeros(len(plants))
    for n in range(len(plants)):
        out[n] = loop(plants[n], gains, leader)
    return out
