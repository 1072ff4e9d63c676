"""The last judgement: of every joint's best few candidates, which four are downloaded together."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Controllers = npt.NDArray[np.int32]
Judge = Callable[[Controllers], Floats]

# A joint whose cost in company is this much above its best elsewhere is exchanged for its other candidates.
WORSE = 1.03
ROUNDS = 3
ALTERNATIVES = 4


def choose(start: Controllers, contenders: Controllers, judge: Judge) -> tuple[Controllers, Floats, Floats]:
    """The best combination (4, 12) with the costs of `start` and of itself (4,); no joint costs more than in `start`.

    `contenders` (k, 4, 12) hold the k-th best of every joint. Each row is judged as it stands, then the best of every
    joint together; where a joint turns out worse among its new neighbours, its other candidates are tried there.
    """
    rows = np.concatenate([start[None], contenders])
    costs = judge(rows)
    before = costs[0]
    mixed = _best_of_each(rows, costs)
    for _ in range(ROUNDS):
        now = judge(mixed[None])[0]
        rows, costs = np.concatenate([rows, mixed[None]]), np.concatenate([costs, now[None]])
        disappointing = np.flatnonzero(now > WORSE * costs.min(axis=0))
        if not disappointing.size:
            break
        tried = _exchanged(mixed, contenders, disappointing)
        outcome = judge(tried)
        rows, costs = np.concatenate([rows, tried]), np.concatenate([costs, outcome])
        mixed = tried[int(np.argmin(outcome.sum(axis=1)))]
    fair = (costs <= before).all(axis=1)
    best = int(np.argmin(np.where(fair, costs.sum(axis=1), np.inf)))
    return rows[best].copy(), before, costs[best]


def _best_of_each(rows: Controllers, costs: Floats) -> Controllers:
    best: Controllers = rows[0].copy()
    for joint, row in enumerate(np.argmin(costs, axis=0)):
        best[joint] = rows[row, joint]
    return best


def _exchanged(mixed: Controllers, contenders: Controllers, joints: npt.NDArray[np.intp]) -> Controllers:
    """Copies of `mixed` with one of these joints replaced by each of its other candidates."""
    tried = []
    for joint in joints:
        for other in contenders[:ALTERNATIVES, joint]:
            if not np.array_equal(other, mixed[joint]):
                row = mixed.copy()
                row[joint] = other
                tried.append(row)
    return np.stack(tried) if tried else mixed[None].copy()
