"""What each erratum of the printed equations does: to a free arm's energy, and to a motion under the controllers.

Everything else is corrected. The arm is the printed one (`greywhale.arm.printed`), the law in plain floats; so the
sets' feet and the change of error can be read in other ways too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from greywhale.arm.printed import BODY_ERRATA, ERRATA, PrintedBody, motor_equation
from greywhale.base.types import Controllers, Floats
from greywhale.files.arm import load_arm
from greywhale.fuzzy.settings import GAIN_UNIT, SET_UNIT
from greywhale.loop import CONTROLLER_COLUMNS
from greywhale.protocol.firmware import JOINTS
from greywhale_paper.work.motions import PERIOD_MS, printed

SWING_S, SWING_STEP_S = 5.0, 5e-4
SWING = (0.0, 0.4, -0.6, 0.2, 2.0, -1.0, 1.5, 3.0)  # rad and rad/s of the free arm at the start
RUNS_AWAY_J = 100.0
STEP_S = 1e-3
LEVELS = (0.0, 1.0, 0.4, -0.6, -1.0, 0.2)  # rad, of the multi-step
HOLD_S = 2.0  # s, each level
SUPPLY_V = 15.0
ARMS = ("white_box", "grey_box")


@dataclass(frozen=True)
class Law:
    """Four fuzzy PD+I controllers in floats. `crisp` sets end at their plateau; `rate` takes de/dt for the change."""

    sets: Floats  # (4, 8)
    gains: Floats  # (4, 4): Kp, Kd, Ki, Ku
    crisp: bool = False
    rate: bool = False

    @classmethod
    def of(cls, rows: Controllers, crisp: bool = False, rate: bool = False) -> Law:
        """As a board stores them, int32 (4, 13)."""
        names = CONTROLLER_COLUMNS
        sets = rows[:, [names.index(name) for name in names[:8]]] / SET_UNIT
        gains = rows[:, [names.index(name) for name in ("kp", "kd", "ki")]] / GAIN_UNIT
        ku = rows[:, [names.index("ku_mv")]] / 1000.0
        return cls(sets.astype(np.float64), np.hstack([gains, ku]), crisp, rate)

    def fuzzy(self, e: Floats, change: Floats) -> tuple[Floats, npt.NDArray[np.bool_]]:
        """u_fuzzy of each joint (..., 4), and where no rule fires; `change` is that of 20 ms."""
        per = 1000.0 / PERIOD_MS if self.rate else 1.0
        x = np.clip(self.gains[:, 0] * e, -1.0, 1.0)
        y = np.clip(self.gains[:, 1] * change * per, -1.0, 1.0)
        n, z, p = self._memberships(x, self.sets[:, :4])
        nc, zc, pc = self._memberships(y, self.sets[:, 4:])
        down = np.maximum(np.maximum(np.minimum(n, nc), np.minimum(n, zc)), np.minimum(z, nc))
        up = np.maximum(np.maximum(np.minimum(p, pc), np.minimum(p, zc)), np.minimum(z, pc))
        none = np.maximum(np.maximum(np.minimum(z, zc), np.minimum(n, pc)), np.minimum(p, nc))
        total = down + none + up
        silent = total <= 0.0
        return np.where(silent, 0.0, (up - down) / np.where(silent, 1.0, total)), silent

    def _memberships(self, x: Floats, corners: Floats) -> tuple[Floats, Floats, Floats]:
        left, a, c, right = corners.T
        if self.crisp:
            low, high = (x <= left).astype(np.float64), (x >= right).astype(np.float64)
        else:
            low, high = np.clip(x / left, 0.0, 1.0), np.clip(x / right, 0.0, 1.0)
        return low, np.clip(1.0 - np.where(x < 0.0, x / a, x / c), 0.0, 1.0), high


def surface(rows: Controllers, joint: int, points: int = 201) -> Floats:
    """The fuzzy output of a joint's sets over an even grid of change of error (rows) and error (columns), -1 to 1."""
    law = Law.of(np.repeat(rows[joint][None], JOINTS, axis=0))
    law = Law(law.sets, np.ones_like(law.gains))
    y, x = np.meshgrid(np.linspace(-1.0, 1.0, points), np.linspace(-1.0, 1.0, points), indexing="ij")
    u, _ = law.fuzzy(*(np.repeat(one.ravel()[:, None], JOINTS, axis=1) for one in (x, y)))
    return u[:, 0].reshape(x.shape)


def follow(
    arm: str,
    wrong: frozenset[str],
    law: Law,
    levels: Sequence[float] | None = None,
    hold_s: float | None = None,
    period_ms: int = PERIOD_MS,
) -> Floats:
    """Errors (rows, 4), rad, at every ms of a leader that jumps through `levels` (rad), with the errata in `wrong`.

    Motor damping is implicit, and so is friction, for which each joint counts alone: the paper's motors are so heavy
    that the links hardly couple them.
    """
    levels, hold_s = LEVELS if levels is None else levels, HOLD_S if hold_s is None else hold_s
    parameters = load_arm(arm)
    right = set(ERRATA) - wrong
    body = PrintedBody(parameters, right)
    inertia, push, share, drag = motor_equation([joint.motor for joint in parameters.joint], right)
    friction = np.array([joint.friction.coulomb for joint in parameters.joint])
    q: Floats = np.zeros(4)
    v, u, before, total = q.copy(), q.copy(), q.copy(), q.copy()
    rows = round(len(levels) * hold_s / STEP_S)
    errors = np.empty((rows, 4))
    for k in range(rows):
        e = errors[k] = levels[int(k * STEP_S / hold_s)] - q
        if k % period_ms == 0:
            total = total + period_ms * STEP_S * e
            change = (e - before) * PERIOD_MS / period_ms if k else np.zeros(4)
            before = e
            wanted = law.gains[:, 3] * law.fuzzy(e, change)[0] + law.gains[:, 2] * total
            u = np.clip(wanted, -SUPPLY_V, SUPPLY_V, dtype=np.float64)
        torque = push * u - share * body.bias(q, v)
        mass = body.mass_matrix(q) + np.diag(inertia)
        yielding = np.linalg.inv(mass + STEP_S * np.diag(drag))
        v = yielding @ (mass @ v + STEP_S * torque)
        v = np.sign(v) * np.maximum(np.abs(v) - STEP_S * friction * np.diag(yielding), 0.0)
        q = q + STEP_S * v
    return errors


def total_mse(errors: Floats) -> float:
    """The paper's: summed over the joints, rad²."""
    return float(np.mean(errors**2, axis=0).sum())


def swing(wrong: frozenset[str]) -> float | None:
    """J: largest change of energy of a free arm without friction (Runge-Kutta 4); None where it runs away."""
    body = PrintedBody(load_arm("white_box"), set(ERRATA) - wrong)

    def rate(state: Floats) -> Floats:
        q, v = state[:4], state[4:]
        return np.concatenate([v, np.linalg.solve(body.mass_matrix(q), -body.bias(q, v))])

    def energy(state: Floats) -> float:
        return body.kinetic_energy(state[:4], state[4:]) + body.potential_energy(state[:4])

    state = np.array(SWING)
    start, worst = energy(state), 0.0
    for _ in range(round(SWING_S / SWING_STEP_S)):
        a = rate(state)
        b = rate(state + 0.5 * SWING_STEP_S * a)
        c = rate(state + 0.5 * SWING_STEP_S * b)
        d = rate(state + SWING_STEP_S * c)
        state = state + SWING_STEP_S / 6 * (a + 2 * b + 2 * c + d)
        worst = max(worst, abs(energy(state) - start))
        if not worst <= RUNS_AWAY_J:
            return None
    return worst


def cases() -> dict[str, tuple[str, ...]]:
    """Each erratum alone, those of the links together, and all."""
    alone: dict[str, tuple[str, ...]] = {name: (name,) for name in ERRATA}
    return alone | {"E1 to E8": BODY_ERRATA, "all": tuple(ERRATA)}


def effect(seed: int, names: list[str]) -> dict[str, Any]:
    """What the errata `names` do together: energy (J), and for each arm largest angle (rad) and MSE as a ratio.

    Nothing is drawn by `seed`.
    """
    wrong = frozenset(names)
    law = Law.of(printed("before_tuning"))
    found: dict[str, Any] = {"energy": swing(wrong) if wrong & set(BODY_ERRATA) else 0.0}
    for arm in ARMS:
        correct, now = follow(arm, frozenset(), law), follow(arm, wrong, law)
        found[arm] = {"angle": float(np.abs(now - correct).max()), "mse": total_mse(now) / total_mse(correct)}
    return found
