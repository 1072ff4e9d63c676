"""Least squares on windows, joint by joint in lock step.

It is Levenberg-Marquardt; each set of joints that feel each other has a damping of its own. With one trust region for
all, a joint that hunts in its gap, whose residual is rough, would hold up the others. Several dampings are tried at
once, because a batch of simulations costs little more than one. Nobody can know how a joint started in its gap, so a
model may miss some windows far more than its mean window. Such windows count with the logarithm of their misfit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from greywhale.base.types import Flags, Floats
from greywhale.identify.space import COUPLED, WHOLE_ARM, Space
from greywhale.identify.windows import WindowResidual
from greywhale.protocol.firmware import JOINTS

DAMPINGS = (0.02, 0.3, 5.0, 100.0)  # times a block's last damping
LARGEST_STEP = 1.0  # of a searched number, in doubts
MOST_DAMPING = 1e8  # with more of it no step moves anything
ENOUGH = 2e-4  # a fit ends when a step gains less than this share of the cost
ROUGHLY_ENOUGH = 1e-3  # of fits that are compared with each other, and of those to simulated logs


@dataclass
class _Block:
    """The numbers of joints that feel each other."""

    joints: tuple[int, ...]
    numbers: NDArray[np.intp]
    rows: NDArray[np.intp]  # of the residual, of these joints
    damping: float = 0.1
    done: bool = False


class WindowFit:
    """One fit, of all searched numbers or of those marked `free`, until a step gains less than `enough`. The misfit
    that counts as usual is measured where it starts.
    """

    def __init__(
        self,
        residual: WindowResidual,
        space: Space,
        start: Floats,
        free: Flags | None = None,
        enough: float = ENOUGH,
    ) -> None:
        self._residual = residual
        self._enough = enough
        self._space = space
        self._free = np.ones(len(start), dtype=bool) if free is None else free
        self._nominal = space.start()
        self._doubts = space.doubts()
        low, high = space.bounds()
        self._low, self._high = low, high
        self.x = np.clip(start, low, high)
        self.simulations = 0
        self._joint_of = residual.joint_of
        self._windows = int(residual.clusters.max()) + 1
        self._window_of = residual.joint_of * self._windows + residual.clusters
        blocks = [*(self._block(joints, joints) for joints in COUPLED), self._block(tuple(range(JOINTS)), (WHOLE_ARM,))]
        self._blocks = [block for block in blocks if len(block.numbers)]
        self._numbers = self._simulate(self.x[None])[0]
        misfit = self._misfit(self._numbers)
        usual = residual.limits.windows.usual_misfit
        self._usual: Floats = usual * np.maximum(np.mean(misfit, axis=1), 1e-9)
        self._costs = self._costs_of(self.x, self._numbers)

    def _block(self, joints: tuple[int, ...], whose: tuple[int, ...]) -> _Block:
        """The numbers of `whose`, which move these joints."""
        numbers = [n for n, one in enumerate(self._space.parameters) if one.joint in whose and self._free[n]]
        return _Block(joints, np.array(numbers, dtype=np.intp), np.flatnonzero(np.isin(self._joint_of, joints)))

    def run(self, most_steps: int, report: Callable[[float], None] = lambda share: None) -> Floats:
        """The best point found; `report` gets the share of the steps that are done."""
        with threadpool_limits(limits=1, user_api="blas"):
            for number in range(most_steps):
                if all(block.done for block in self._blocks):
                    break
                self._step()
                report((number + 1) / most_steps)
        return self.x

    def _step(self) -> None:
        """Work out one set of derivatives, then take a step of every block: the best of several."""
        jacobian = self.derivatives()
        weights = self._weights(self._numbers)
        trials = np.tile(self.x, (len(DAMPINGS), 1))
        for block in self._blocks:
            if not block.done:
                trials[:, block.numbers] += self._proposed(block, jacobian, weights)
        trials = np.clip(trials, self._low, self._high)
        numbers = self._simulate(trials)
        costs = np.array([self._costs_of(x, one) for x, one in zip(trials, numbers, strict=True)])
        known = np.vstack([self.x, trials]), np.vstack([self._numbers, numbers])
        for number, block in enumerate(self._blocks):
            if not block.done:
                self._accept(number, block, trials, costs[:, number])
        self._numbers = self._together(*known)
        self._costs = self._costs_of(self.x, self._numbers)

    def _together(self, points: Floats, numbers: Floats) -> Floats:
        """The residual where the fit now stands. Steps from different trials have not been simulated together."""
        same = np.flatnonzero(np.all(points == self.x, axis=1))
        found: Floats = numbers[same[0]] if len(same) else self._simulate(self.x[None])[0]
        return found

    def _accept(self, number: int, block: _Block, trials: Floats, costs: Floats) -> None:
        best = int(np.argmin(costs))
        gained = self._costs[number] - costs[best]
        if gained > 0.0:
            self.x[block.numbers] = trials[best, block.numbers]
            block.damping = max(DAMPINGS[best] * block.damping, 1e-6)
        else:
            block.damping *= 1e3
        block.done = gained < self._enough * self._costs[number] if gained > 0.0 else block.damping > MOST_DAMPING

    def _proposed(self, block: _Block, jacobian: Floats, weights: Floats) -> Floats:
        """Levenberg-Marquardt steps of one block (dampings, numbers); a number at its bound does not leave the box."""
        rows = block.rows
        part = np.ascontiguousarray(jacobian[np.ix_(rows, block.numbers)])
        doubts = self._doubts[block.numbers]
        weighted = part * weights[rows, None]
        matrix = weighted.T @ part + np.diag(doubts**-2.0)
        x = self.x[block.numbers]
        slope = weighted.T @ self._numbers[rows] + (x - self._nominal[block.numbers]) / doubts**2
        low, high = self._low[block.numbers], self._high[block.numbers]
        free = ~(((x <= low) & (slope > 0.0)) | ((x >= high) & (slope < 0.0)))
        inner = matrix[np.ix_(free, free)]
        found = np.zeros((len(DAMPINGS), len(x)))
        for step, share in zip(found, DAMPINGS, strict=True):
            step[free] = -np.linalg.solve(inner + share * block.damping * np.diag(np.diag(inner)), slope[free])
            longest = float(np.max(np.abs(step) / doubts))
            step *= min(1.0, LARGEST_STEP / longest) if longest > 0.0 else 1.0
        return found

    def derivatives(self) -> Floats:
        """Of the residual where the fit stands, (numbers of the residual, searched numbers), by finite differences.

        Joints that do not feel each other are varied together. Numbers of blocks that are done are left out, save where
        they are varied with others.
        """
        left = np.zeros(len(self.x), dtype=bool)
        for block in self._blocks:
            left[block.numbers] = not block.done
        groups = [group for group in self._space.groups() if left[group].any()]
        steps = self._space.steps
        ahead = np.where(self.x + steps > self._high, -steps, steps)
        points = np.tile(self.x, (len(groups), 1))
        for row, group in enumerate(groups):
            points[row, group] += ahead[group]
        moved = self._simulate(points)
        moved -= self._numbers
        jacobian = np.zeros((len(self.x), len(self._numbers)))  # a searched number's derivatives lie side by side
        for row, group in enumerate(groups):
            for number in group:
                np.divide(moved[row], ahead[number], out=jacobian[number])
        return jacobian.T

    def _simulate(self, points: Floats) -> Floats:
        self.simulations += len(points)
        return self._residual(self._space, points)

    def _misfit(self, numbers: Floats) -> Floats:
        """Sums of squares (joints, windows)."""
        size = JOINTS * self._windows
        sums = np.bincount(self._window_of, numbers**2, size).astype(np.float64)
        return sums.reshape(JOINTS, self._windows)

    def _weights(self, numbers: Floats) -> Floats:
        """Derivative of a window's cost by its sum of squares, for every number."""
        weights: Floats = (1.0 / (1.0 + self._misfit(numbers) / self._usual[:, None])).ravel()[self._window_of]
        return weights

    def _costs_of(self, x: Floats, numbers: Floats) -> Floats:
        """Half of the sum that each block is to minimise, doubts about the user's arm included."""
        usual = self._usual[:, None]
        per_joint = np.sum(usual * np.log1p(self._misfit(numbers) / usual), axis=1)
        nominal = ((x - self._nominal) / self._doubts) ** 2
        costs = [per_joint[list(block.joints)].sum() + nominal[block.numbers].sum() for block in self._blocks]
        return np.array(costs) / 2.0
