"""Derives the arm's mass matrix and bias torques from its kinematics and compares them with docs/arm.md, term by term.

Needs sympy: python docs/derivation/arm.py prints the derived expressions and fails where the closed form differs.
"""

from __future__ import annotations

import sympy as sp

q = sp.symbols("q0:4", real=True)
v = sp.symbols("v0:4", real=True)
m = sp.symbols("m0:4", positive=True)
M = sp.Symbol("M", nonnegative=True)
L = sp.symbols("L0:4", positive=True)
cg = sp.symbols("c0:4", positive=True)
g = sp.Symbol("g", positive=True)
Ixx = sp.symbols("Ixx0:4", positive=True)
Iyy = sp.symbols("Iyy0:4", positive=True)
Izz = (*sp.symbols("Izz0:3", positive=True), Iyy[3])  # link 3: the average of yy and zz stands for both

ZERO = sp.zeros(3, 1)
Y = sp.Matrix([0, 1, 0])
Z = sp.Matrix([0, 0, 1])
X = sp.Matrix([1, 0, 0])


def derive() -> tuple[sp.Matrix, sp.Matrix]:
    """Mass matrix and bias by Lagrange's equations: links as rigid bodies, y up, gravity along -y."""
    turn0 = sp.rot_ccw_axis2(q[0])
    turn1 = turn0 * sp.rot_ccw_axis3(q[1])
    turn2 = turn1 * sp.rot_ccw_axis3(q[2])
    turn3 = turn2 * sp.rot_ccw_axis1(q[3])
    shoulder = L[0] * Y
    wrist = shoulder + turn1 * L[1] * X
    hand = wrist + turn2 * L[2] * X
    bodies = [
        (m[0], cg[0] * Y, turn0, 0),
        (m[1], shoulder + turn1 * cg[1] * X, turn1, 1),
        (m[2], wrist + turn2 * cg[2] * X, turn2, 2),
        (m[3], hand + turn3 * cg[3] * X, turn3, 3),
    ]
    axes = [Y, turn0 * Z, turn1 * Z, turn2 * X]

    mass = sp.zeros(4, 4)
    potential = sp.Integer(0)
    for weight, centre, turn, index in bodies:
        moving = centre.jacobian(q)
        local = sp.Matrix.hstack(*[turn.T * axes[i] if i <= index else ZERO for i in range(4)])
        inertia = sp.diag(Ixx[index], Iyy[index], Izz[index])
        mass += weight * moving.T * moving + local.T * inertia * local
        potential += weight * g * centre[1]
    tip = hand + turn3 * L[3] * X
    mass += M * tip.jacobian(q).T * tip.jacobian(q)
    potential += M * g * tip[1]

    bias = sp.zeros(4, 1)
    for i in range(4):
        bias[i] = sp.diff(potential, q[i])
        for j in range(4):
            for k in range(4):
                christoffel = sp.diff(mass[i, j], q[k]) + sp.diff(mass[i, k], q[j]) - sp.diff(mass[j, k], q[i])
                bias[i] += christoffel * v[j] * v[k] / 2
    return mass, bias


def closed_form() -> tuple[sp.Matrix, sp.Matrix]:
    """Mass matrix and bias as docs/arm.md states them."""
    carried = m[2] + m[3] + M
    second1 = m[1] * cg[1] ** 2 + carried * L[1] ** 2
    second2 = m[2] * cg[2] ** 2 + m[3] * (L[2] + cg[3]) ** 2 + M * (L[2] + L[3]) ** 2
    first1 = m[1] * cg[1] + carried * L[1]
    first2 = m[2] * cg[2] + m[3] * (L[2] + cg[3]) + M * (L[2] + L[3])
    h = L[1] * first2
    x, y, e = Ixx[2] + Ixx[3], Iyy[2] + Iyy[3] + second2, Izz[2] + Izz[3] + second2
    phi = q[1] + q[2]
    sin, cos = sp.sin, sp.cos

    mass = sp.zeros(4, 4)
    mass[0, 0] = (
        Iyy[0]
        + Ixx[1] * sin(q[1]) ** 2
        + (Iyy[1] + second1) * cos(q[1]) ** 2
        + x * sin(phi) ** 2
        + y * cos(phi) ** 2
        + 2 * h * cos(q[1]) * cos(phi)
    )
    mass[0, 3] = mass[3, 0] = Ixx[3] * sin(phi)
    mass[3, 3] = Ixx[3]
    mass[1, 1] = Izz[1] + second1 + e + 2 * h * cos(q[2])
    mass[1, 2] = mass[2, 1] = e + h * cos(q[2])
    mass[2, 2] = e

    d1 = (Ixx[1] - Iyy[1] - second1) * sin(2 * q[1]) + (x - y) * sin(2 * phi) - 2 * h * sin(q[1] + phi)
    d2 = (x - y) * sin(2 * phi) - 2 * h * cos(q[1]) * sin(phi)
    w = v[1] + v[2]
    roll = Ixx[3] * cos(phi)
    bias = sp.Matrix(
        [
            (d1 * v[1] + d2 * v[2]) * v[0] + roll * w * v[3],
            -d1 * v[0] ** 2 / 2
            - h * sin(q[2]) * v[2] * (2 * v[1] + v[2])
            - roll * v[0] * v[3]
            + g * (first1 * cos(q[1]) + first2 * cos(phi)),
            -d2 * v[0] ** 2 / 2 + h * sin(q[2]) * v[1] ** 2 - roll * v[0] * v[3] + g * first2 * cos(phi),
            roll * v[0] * w,
        ]
    )
    return mass, bias


def is_zero(expression: sp.Expr) -> bool:
    """True if it is zero for all angles: in exponentials, every identity of sines and cosines is an expansion."""
    turns = sp.symbols("t0:4")
    exponential = {}
    for angle, turn in zip(q, turns, strict=True):
        exponential[sp.sin(angle)] = (turn - 1 / turn) / (2 * sp.I)
        exponential[sp.cos(angle)] = (turn + 1 / turn) / 2
    return bool(sp.expand(sp.expand_trig(expression).subs(exponential)) == 0)


def main() -> None:
    mass, bias = derive()
    mass_closed, bias_closed = closed_form()
    for i in range(4):
        for j in range(i, 4):
            if not is_zero(mass[i, j] - mass_closed[i, j]):
                raise SystemExit(f"M[{i},{j}] of docs/arm.md differs from the derivation.")
            print(f"M[{i},{j}] =", mass_closed[i, j])
        if not is_zero(bias[i] - bias_closed[i]):
            raise SystemExit(f"bias[{i}] of docs/arm.md differs from the derivation.")
        print(f"bias[{i}] =", bias_closed[i])
    print("The closed form equals the derivation.")


if __name__ == "__main__":
    main()
