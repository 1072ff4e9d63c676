"""The last judgement: it chooses, from every joint's best few candidates, the four that are uploaded together."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from greywhale.base.types import Controllers, Floats
from greywhale.tune.limits import TUNING_LIMITS, ChoiceLimits

Judge = Callable[[Controllers], Floats]

ROUNDS = 3  # of trying other candidates of joints that disappoint


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
    then the best of every joint together. Where a joint turns out worse among its new neighbours, its other
    candidates are tried there, also the one that it had in `start`. If that gains little, the joints of `start` are
    exchanged one after the other instead.
    """
    alone = np.repeat(start[None], len(start), axis=0)
    for joint in range(len(start)):
        alone[joint, joint] = contenders[0, joint]
    rows = np.concatenate([start[None], contenders, alone])
    costs = judge(rows)
    before = costs[0]
    mixed = _take_best_of_each(rows, costs)
    for _ in range(ROUNDS):
        now = judge(mixed[None])[0]
        rows, costs = np.concatenate([rows, mixed[None]]), np.concatenate([costs, now[None]])
        disappointing = np.flatnonzero(now > limits.worse_ratio * costs.min(axis=0))
        if not disappointing.size:
            break
        tried = _exchange(mixed, np.concatenate([contenders, start[None]]), disappointing)
        outcome = judge(tried)
        rows, costs = np.concatenate([rows, tried]), np.concatenate([costs, outcome])
        mixed = tried[int(np.argmin(outcome.sum(axis=1)))]
    fair = is_fair(costs, before, limits.joint_slack)
    best = int(np.argmin(np.where(fair, costs.sum(axis=1), np.inf)))
    chosen, cost = rows[best].copy(), costs[best]
    hoped_for = before.sum() - costs.min(axis=0).sum()
    if before.sum() - cost.sum() < limits.enough_gain_share * hoped_for:
        built, its = _build_up(start, before, before, contenders, judge, limits.joint_slack)
        if its.sum() < cost.sum():
            chosen, cost = built, its
    # Once more: a joint may now accept a candidate that it could not accept among its old neighbours.
    chosen, cost = _build_up(chosen, cost, before, contenders, judge, limits.joint_slack)
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


def _build_up(
    chosen: Controllers, cost: Floats, before: Floats, contenders: Controllers, judge: Judge, slack: float
) -> tuple[Controllers, Floats]:
    """`chosen`, with one joint after the other exchanged for the fair candidate that lowers the sum most."""
    for joint in range(len(chosen)):
        tried = _exchange(chosen, contenders, np.array([joint]))
        costs = judge(tried)
        sums = np.where(is_fair(costs, before, slack), costs.sum(axis=1), np.inf)
        best = int(np.argmin(sums))
        if sums[best] < cost.sum():
            chosen, cost = tried[best], costs[best]
    return chosen, cost


def _take_best_of_each(rows: Controllers, costs: Floats) -> Controllers:
    best: Controllers = rows[0].copy()
    for joint, row in enumerate(np.argmin(costs, axis=0)):
        best[joint] = rows[row, joint]
    return best


def _exchange(mixed: Controllers, others: Controllers, joints: npt.NDArray[np.intp]) -> Controllers:
    """Copies of `mixed` with one of these joints replaced by each of its other candidates."""
    tried = []
    for joint in joints:
        for other in np.unique(others[:, joint], axis=0):
            if not np.array_equal(other, mixed[joint]):
                row = mixed.copy()
                row[joint] = other
                tried.append(row)
    return np.stack(tried) if tried else mixed[None].copy()
