"""Prints the table of docs/errata.md: what each erratum of the printed equations does.

Everything else is corrected. Three figures show the effect: the energy that a frictionless arm without motors gains or
loses in 5 s, and the change of a motion under the paper's controllers (largest angle, total mean squared error).
"""

from __future__ import annotations

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.printed import ERRATA, PrintedBody, motor_equation
from greywhale.files.arm import load_arm

SWING_S, SWING_DT = 5.0, 5e-4
LOOP_S, LOOP_DT, PERIOD = 12.0, 1e-3, 20  # controllers every 20 ms
GAINS = np.array(
    [
        [0.513, 0.160, 0.313, 15.0],
        [0.590, 0.147, 0.201, 11.55],
        [0.630, 0.244, 0.251, 13.15],
        [0.782, 0.169, 0.233, 14.5],
    ]
)


def energy_drift(body: PrintedBody) -> float:
    """J: largest change of energy of a free arm, Runge-Kutta 4; infinite when the arm runs away."""

    def rate(state: np.ndarray) -> np.ndarray:
        q, v = state[:4], state[4:]
        return np.concatenate([v, np.linalg.solve(body.mass_matrix(q), -body.bias(q, v))])

    def energy(state: np.ndarray) -> float:
        return body.kinetic_energy(state[:4], state[4:]) + body.potential_energy(state[:4])

    state = np.array([0.0, 0.4, -0.6, 0.2, 2.0, -1.0, 1.5, 3.0])
    start, worst = energy(state), 0.0
    for _ in range(round(SWING_S / SWING_DT)):
        a = rate(state)
        b = rate(state + 0.5 * SWING_DT * a)
        c = rate(state + 0.5 * SWING_DT * b)
        d = rate(state + SWING_DT * c)
        state = state + SWING_DT / 6 * (a + 2 * b + 2 * c + d)
        worst = max(worst, abs(energy(state) - start))
        if not np.isfinite(worst) or worst > 100.0:
            return float("inf")
    return worst


def fuzzy(x: float, y: float) -> float:
    """The paper's sets before tuning, as a partition of unity at +-0.5."""
    ne, pe, nc, pc = (min(1.0, max(0.0, 2.0 * s)) for s in (-x, x, -y, y))
    ze, zc = max(0.0, 1 - 2 * abs(x)), max(0.0, 1 - 2 * abs(y))
    negative, positive = max(min(ne, nc), min(ne, zc), min(ze, nc)), max(min(pe, pc), min(pe, zc), min(ze, pc))
    return (positive - negative) / (negative + positive + max(min(ze, zc), min(ne, pc), min(pe, nc)))


def follow(arm: ArmParameters, wrong: set[str]) -> tuple[np.ndarray, float]:
    """Angles and total MSE of a simulated multi-step with the errata in `wrong`; motor damping is implicit."""
    right = set(ERRATA) - wrong
    body = PrintedBody(arm, right)
    inertia, push, share, drag = motor_equation([joint.motor for joint in arm.joint], right)
    q, v, u, before, total = np.zeros(4), np.zeros(4), np.zeros(4), np.zeros(4), np.zeros(4)
    angles, error_sum = [], 0.0
    levels = np.array([0.0, 1.0, 0.4, -0.6, -1.0, 0.2])
    for k in range(round(LOOP_S / LOOP_DT)):
        e = levels[min(k // 2000, 5)] - q
        error_sum += float(e @ e)
        if k % PERIOD == 0:
            total += PERIOD * LOOP_DT * e
            change = (e - before) if k else np.zeros(4)
            before = e
            for i, (kp, kd, ki, ku) in enumerate(GAINS):
                x, y = np.clip(kp * e[i], -1, 1), np.clip(kd * change[i], -1, 1)
                u[i] = np.clip(ku * fuzzy(float(x), float(y)) + ki * total[i], -15, 15)
        mass = body.mass_matrix(q) + np.diag(inertia)
        torque = push * u - share * body.bias(q, v)
        v = np.linalg.solve(mass + LOOP_DT * np.diag(drag), mass @ v + LOOP_DT * torque)
        q = q + LOOP_DT * v
        angles.append(q)
    return np.array(angles), error_sum / len(angles)


def main() -> None:
    arms = {name: load_arm(name) for name in ("white_box", "grey_box")}
    reference = {name: follow(arm, set()) for name, arm in arms.items()}
    print("corrected", energy_drift(PrintedBody(arms["white_box"], ERRATA)), {n: r[1] for n, r in reference.items()})
    for wrong in [*({name} for name in ERRATA), set(ERRATA) - {"E14"}, set(ERRATA)]:
        swing = energy_drift(PrintedBody(arms["white_box"], set(ERRATA) - wrong)) if wrong != {"E14"} else 0.0
        cells = []
        for name, arm in arms.items():
            angles, mse = follow(arm, wrong)
            cells.append(
                f"{np.abs(angles - reference[name][0]).max():.2e} rad | {100 * (mse / reference[name][1] - 1):+.2f} %"
            )
        print(
            f"| {', '.join(sorted(wrong)) if len(wrong) < 3 else len(wrong)} | {swing:.2g} J | {' | '.join(cells)} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
