"""The last judgement: it chooses, from every joint's best few candidates, the four that are uploaded together."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from greywhale.base.types import Controllers, Floats
from greywhale.tune.limits import TUNING_LIMITS, ChoiceLimits

Judge = Callable[[Controllers], Floats]


class CachedJudge:
    """A judge that does not judge the same row again: a row's costs (4,) depend on that row (4, 13) alone."""

    def __init__(self, judge: Judge) -> None:
        self._judge = judge
        self._known: dict[bytes, Floats] = {}

    def __call__(self, rows: Controllers) -> Floats:
        """The costs (n, 4) of rows (n, 4, 13)."""
        keys = [row.tobytes() for row in rows]
        new = {key: place for place, key in enumerate(keys) if key not in self._known}
        if new:
            self._known.update(zip(new, self._judge(rows[list(new.values())]), strict=True))
        return np.stack([self._known[key] for key in keys])


def choose(
    start: Controllers, contenders: Controllers, judge: Judge, limits: ChoiceLimits = TUNING_LIMITS.choice
) -> tuple[Controllers, Floats, Floats]:
    """The best combination (4, 13), with the costs of `start` and of itself (4,).

    No joint costs more than `joint_slack` times what it costs in `start`. `contenders` (k, 4, 13) hold the k-th
    best of every joint. Each row is judged as it stands, then every joint's best among the neighbours of `start`,
    then the best of every joint together. In the best of these rows, the joints are exchanged one after the other.
    """
    alone = np.repeat(start[None], len(start), axis=0)
    for joint in range(len(start)):
        alone[joint, joint] = contenders[0, joint]
    rows = np.concatenate([start[None], contenders, alone])
    costs = judge(rows)
    before = costs[0]
    mixed = _take_best_of_each(rows, costs)[None]
    rows, costs = np.concatenate([rows, mixed]), np.concatenate([costs, judge(mixed)])
    fair = is_fair(costs, before, limits.joint_slack)
    best = int(np.argmin(np.where(fair, costs.sum(axis=1), np.inf)))
    chosen, cost = rows[best].copy(), costs[best]
    # A joint may now accept a candidate that it could not accept among its old neighbours.
    for joint in range(len(chosen)):
        tried = _exchange(chosen, contenders, joint)
        outcome = judge(tried)
        sums = np.where(is_fair(outcome, before, limits.joint_slack), outcome.sum(axis=1), np.inf)
        if sums.min() < cost.sum():
            best = int(np.argmin(sums))
            chosen, cost = tried[best], outcome[best]
    return chosen, before, cost


def next_best(
    after: Controllers,
    contenders: Controllers,
    joint: int,
    judge: Judge,
    still: npt.NDArray[np.intp],
    limits: ChoiceLimits = TUNING_LIMITS.choice,
) -> Controllers:
    """The controllers (n, 13) that a joint of `after` (4, 13) may have in the place of its own.

    The best of the contenders (k, 4, 13) come first, then those of the rows `still`, in which little swings.
    """
    rows = np.repeat(after[None], len(contenders), axis=0)
    rows[:, joint] = contenders[:, joint]
    costs = judge(rows).sum(axis=1)
    order = [k for k in np.argsort(costs, kind="stable") if not np.array_equal(contenders[k, joint], after[joint])]
    tried = list(dict.fromkeys([*order[: limits.second_chances], *still]))
    chosen: Controllers = contenders[tried, joint]
    return chosen


def is_fair(costs: Floats, before: Floats, slack: float) -> npt.NDArray[np.bool_]:
    """True where no joint loses, of costs (..., 4)."""
    fair: npt.NDArray[np.bool_] = np.all(costs <= slack * before, axis=-1)
    return fair


def _take_best_of_each(rows: Controllers, costs: Floats) -> Controllers:
    best: Controllers = rows[0].copy()
    for joint, row in enumerate(np.argmin(costs, axis=0)):
        best[joint] = rows[row, joint]
    return best


def _exchange(mixed: Controllers, others: Controllers, joint: int) -> Controllers:
    """Copies of `mixed` (4, 13) in which a joint has each of the controllers of `others` (k, 4, 13)."""
    choices = np.unique(others[:, joint], axis=0)
    tried: Controllers = np.repeat(mixed[None], len(choices), axis=0)
    tried[:, joint] = choices
    return tried
