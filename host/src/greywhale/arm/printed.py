"""The links' equations as Obadina et al. 2022 print them (Eqs. 2 to 4); every erratum can be corrected by itself.

With all corrections they are the equations of sim/arm. docs/errata.md explains each erratum and its effect. They are
for study only: plain Python, and as printed they do not conserve energy.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import cos, sin

import numpy as np

from greywhale.arm.parameters import ArmParameters, Motor
from greywhale.base.errors import UserError
from greywhale.base.types import Floats

ERRATA = {
    "E1": "A11 is four times too large",
    "E2": "no inertia of link 0 in A11",
    "E3": "C1, v0 v2: -m2 L2cg in the sin(2 q1 + q2) group instead of -m2 L2cg^2 in the sin(2 phi) group",
    "E4": "C2, v0^2: bracket four times too large",
    "E5": "C2: -1/2 Ixx1 sin(2 q1) attached to v1^2 instead of v0^2",
    "E6": "C3, v0^2: groups four and eight times too large",
    "E7": "C3, v1^2: 2 h sin q2 instead of h sin q2",
    "E8": "Iyy3 and Izz3 differ although the matrix does not depend on q3",
    "E14": "Eq. 1: R multiplies the inertia term only, and two terms lack a division by Kt",
}
BODY_ERRATA = tuple(name for name in ERRATA if name != "E14")


def _checked(corrected: Iterable[str]) -> frozenset[str]:
    names = frozenset(corrected)
    unknown = sorted(names - set(ERRATA))
    if unknown:
        raise UserError(f"erratum {unknown[0]} is not known; there are {', '.join(ERRATA)}.")
    return names


class PrintedBody:
    """`mass_matrix(q)` and `bias(q, v)` as printed, except for the errata named in `corrected`; rad, SI units."""

    def __init__(self, arm: ArmParameters, corrected: Iterable[str] = ()) -> None:
        fixed = _checked(corrected)
        self.fixed = fixed
        link0, link1, link2, link3 = arm.link
        tip, carried = arm.tip.mass, link2.mass + link3.mass + arm.tip.mass
        inertia3 = link3.inertia
        yy3, zz3 = (
            (0.5 * (inertia3.yy + inertia3.zz),) * 2 if "E8" in fixed else (inertia3.yy, inertia3.zz)
        )  # about y and z
        reach, end = link2.length + link3.centre, link2.length + link3.length
        self.p1 = link1.mass * link1.centre**2 + carried * link1.length**2
        self.p2 = link2.mass * link2.centre**2 + link3.mass * reach**2 + tip * end**2
        first = link2.mass * link2.centre + link3.mass * reach + tip * end
        self.h = link1.length * first
        self.yaw = link0.inertia.yy if "E2" in fixed else 0.0
        self.xx1, self.yy1, self.zz1 = link1.inertia.xx, link1.inertia.yy, link1.inertia.zz
        self.x, self.y = link2.inertia.xx + inertia3.xx, link2.inertia.yy + yy3 + self.p2
        self.e = link2.inertia.zz + zz3 + self.p2
        self.xx3 = inertia3.xx
        self.m2c2 = link2.mass * link2.centre
        self.m2c2c2 = link2.mass * link2.centre**2
        self.gravity1 = arm.gravity * (link1.mass * link1.centre + carried * link1.length)
        self.gravity2 = arm.gravity * first

    def mass_matrix(self, q: Floats) -> Floats:
        """4x4, kg m^2."""
        q1, q2, phi = q[1], q[2], q[1] + q[2]
        four = 2.0 * (self.xx1 + self.yy1 + self.p1 + self.x + self.y)
        four += 2.0 * (self.yy1 - self.xx1 + self.p1) * cos(2 * q1) + 2.0 * (self.y - self.x) * cos(2 * phi)
        four += 4.0 * self.h * (cos(q2) + cos(2 * q1 + q2))
        m00 = (0.25 * four if "E1" in self.fixed else four) + self.yaw
        m03 = self.xx3 * sin(phi)
        m12 = self.e + self.h * cos(q2)
        m11 = self.zz1 + self.p1 + self.e + 2.0 * self.h * cos(q2)
        return np.array([[m00, 0, 0, m03], [0, m11, m12, 0], [0, m12, self.e, 0], [m03, 0, 0, self.xx3]])

    def bias(self, q: Floats, v: Floats) -> Floats:
        """Velocity and gravity torques, N m."""
        q1, q2, phi = q[1], q[2], q[1] + q[2]
        v0, v1, v2, v3 = v
        h, long = self.h, 2 * q1 + q2
        across = self.x - self.y
        roll = self.xx3 * cos(phi)
        d1 = (self.xx1 - self.yy1 - self.p1) * sin(2 * q1) + across * sin(2 * phi) - 2.0 * h * sin(long)
        d2 = across * sin(2 * phi) - h * (sin(long) + sin(q2))
        if "E3" not in self.fixed:
            d2 += self.m2c2c2 * sin(2 * phi) - self.m2c2 * sin(long)
        c1 = v0 * (v1 * d1 + v2 * d2) + roll * v3 * (v1 + v2)

        square0 = 2.0 * (self.yy1 + self.p1) * sin(2 * q1) - 2.0 * across * sin(2 * phi) + 4.0 * h * sin(long)
        square0 = 0.25 * square0 if "E4" in self.fixed else square0
        stray = -0.5 * self.xx1 * sin(2 * q1) * (v0**2 if "E5" in self.fixed else v1**2)
        c2 = square0 * v0**2 + stray - h * sin(q2) * v2 * (v2 + 2.0 * v1) - roll * v0 * v3

        if "E6" in self.fixed:
            square0 = -0.5 * across * sin(2 * phi) + 0.5 * h * (sin(long) + sin(q2))
        else:
            square0 = -2.0 * across * sin(2 * phi) + 4.0 * h * sin(long) + 2.0 * h * sin(q2)
        square1 = (1.0 if "E7" in self.fixed else 2.0) * h * sin(q2)
        c3 = square0 * v0**2 + square1 * v1**2 - roll * v0 * v3
        c4 = roll * v0 * (v1 + v2)
        g3 = self.gravity2 * cos(phi)
        return np.array([c1, c2 + self.gravity1 * cos(q1) + g3, c3 + g3, c4])

    def kinetic_energy(self, q: Floats, v: Floats) -> float:
        """J, by the mass matrix as it is here."""
        return float(0.5 * v @ self.mass_matrix(q) @ v)

    def potential_energy(self, q: Floats) -> float:
        """J, zero with the arm level."""
        return self.gravity1 * sin(q[1]) + self.gravity2 * sin(q[1] + q[2])


def motor_equation(motors: Iterable[Motor], corrected: Iterable[str] = ()) -> tuple[Floats, Floats, Floats, Floats]:
    """Eq. 1 solved for the accelerations: (A + inertia) q'' = push U - share bias - drag q'; the four vectors."""
    fixed = "E14" in _checked(corrected)
    rows = []
    for m in motors:
        per_volt = m.torque_constant / m.resistance
        share = 1.0 if fixed else 1.0 / m.resistance
        volts = m.torque_constant**2 * m.gear_ratio + m.viscous * m.resistance  # per rad/s, if Kt and Bm were so meant
        drag = volts / m.torque_constant * per_volt if fixed else volts * per_volt
        rows.append((m.inertia * m.gear_ratio, per_volt, share, drag))
    inertia, push, shares, drags = np.array(rows).T
    return inertia, push, shares, drags
