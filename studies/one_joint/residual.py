"""How far candidates are from records, in standard deviations, and how well a fit predicts what it has not seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from greywhale.base.types import Floats
from greywhale.identify.fit import Fit
from studies.one_joint.law import Law
from studies.one_joint.loop import Runner
from studies.one_joint.plant import JointSpace
from studies.one_joint.record import Pieces, Record, pieces_of

BLOCK_S = 0.5  # left out at a time
CORRELATED_S = 0.2
COMPARED_S = 5e-3


@dataclass(frozen=True)
class Part:
    """One record in one way of running it: inside its controller as a whole, or under its voltages over windows."""

    runner: Runner
    pieces: Pieces
    every: int
    weight: float  # of an error, so that a stretch of CORRELATED_S counts as one observation
    blocks: NDArray[np.int64]  # of each error: record and time, as one number

    def errors(self, plants: Floats) -> Floats:
        """Candidates minus record, (candidates, readings), rad."""
        return self.runner.errors(plants, self.pieces, self.every).reshape(len(plants), -1)


def part_of(record: Record, law: Law | None, begin: int, end: int, number: int, window_s: float) -> Part:
    """Rows [begin, end) of the record `number`, in the controller or (None) over windows of so many seconds."""
    period = float(np.median(record.spacing))
    every = max(1, round(COMPARED_S / period))
    pieces = pieces_of(record, begin, end, window_s if law is None else None)
    rows = pieces.first[:, None] + np.arange(0, pieces.rows, every)[None, :]
    block = ((record.time[rows] - record.time[begin]) / BLOCK_S).astype(np.int64)
    observations = len(pieces.first) * pieces.rows * period / CORRELATED_S
    weight = float(np.sqrt(observations / rows.size))
    return Part(Runner(record, law), pieces, every, weight, (block + 1_000_000 * number).ravel())


class JointResidual:
    """Errors in standard deviations, a row of numbers a candidate; the last are distances from what was known."""

    def __init__(self, parts: Sequence[Part], sizes: Sequence[float]) -> None:
        self._parts, self._sizes = parts, sizes

    def __call__(self, space: JointSpace, points: Floats) -> Floats:
        plants = space.plants(points)
        rows = [part.errors(plants) * (part.weight / size) for part, size in zip(self._parts, self._sizes, strict=True)]
        return np.concatenate([*rows, (points - space.start()) / space.doubts], axis=1)


def left_out(fit: Fit[JointSpace], parts: Sequence[Part], sizes: Sequence[float]) -> Floats:
    """Mean squared error of each part (rad²) when every block in turn is predicted from the others.

    By the fit's derivatives: with the block's rows B of the jacobian J, its residual r becomes
    r + B (J'J - B'B)^-1 B'r. Exact where the model is linear in its numbers. Numbers at a bound stay there.
    """
    low, high = fit.space.bounds()
    free = (fit.x > low + fit.space.steps) & (fit.x < high - fit.space.steps)
    jacobian, residual = fit.jacobian[:, free], fit.residual
    information = jacobian.T @ jacobian
    blocks = np.concatenate([part.blocks for part in parts])
    predicted = residual[: len(blocks)].copy()
    for block in np.unique(blocks):
        rows = np.flatnonzero(blocks == block)
        inside, there = jacobian[rows], residual[rows]
        predicted[rows] += inside @ np.linalg.lstsq(information - inside.T @ inside, inside.T @ there, rcond=None)[0]
    ends = np.cumsum([len(part.blocks) for part in parts])[:-1]
    pieces = np.split(predicted, ends)
    weights = [part.weight / size for part, size in zip(parts, sizes, strict=True)]
    return np.array([np.mean(piece**2) / weight**2 for piece, weight in zip(pieces, weights, strict=True)])
