"""The last judgement, on costs that can be worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.loop import default_controller
from greywhale.tune.judge.choose import choose, next_best

BEFORE = default_controller()


def marked(*marks: int) -> np.ndarray:
    """A controller whose joint j carries marks[j]."""
    row = BEFORE.copy()
    row[:, 11] = marks
    return row


class Table:
    """Costs by the joints' marks: 10 for the start's mark 0, else 10 - mark; more in bad company."""

    def __init__(self, *feuds: tuple[tuple[int, int], tuple[int, int]]) -> None:
        self.feuds = feuds

    def __call__(self, rows: np.ndarray) -> np.ndarray:
        costs = 10.0 - rows[:, :, 11].astype(np.float64)
        for (joint, mark), (other, its) in self.feuds:
            together = (rows[:, joint, 11] == mark) & (rows[:, other, 11] == its)
            costs[together, joint] += 50.0
        return np.asarray(costs)


def test_the_judgement_takes_every_joints_best() -> None:
    after, before, costs = choose(marked(0, 0, 0, 0), np.stack([marked(1, 2, 1, 2), marked(3, 1, 2, 1)]), Table())
    assert after[:, 11].tolist() == [3, 2, 2, 2]
    assert before.tolist() == [10, 10, 10, 10]
    assert costs.tolist() == [7, 8, 8, 8]


def test_the_judgement_parts_neighbours_that_quarrel() -> None:
    """Joint 1's best and joint 2's best are good alone, and bad together, which no row had shown."""
    rows = np.stack([marked(4, 4, 1, 4), marked(3, 1, 4, 3), marked(2, 3, 3, 2)])
    after, _, costs = choose(marked(0, 0, 0, 0), rows, Table(((1, 4), (2, 4))))
    assert after[:, 11].tolist() in ([4, 3, 4, 4], [4, 4, 3, 4])
    assert costs.sum() == 40 - 15


def test_no_joint_pays_for_the_others() -> None:
    """Where every new neighbour makes joint 0 worse than it was, only joint 0 itself changes."""
    feuds = [((0, 0), (other, mark)) for other in (1, 2, 3) for mark in (1, 2)]
    worse = [((0, own), (other, mark)) for own in (1, 2) for other in (1, 2, 3) for mark in (1, 2)]
    rows = np.stack([marked(1, 1, 1, 1), marked(2, 2, 2, 2)])
    after, before, costs = choose(marked(0, 0, 0, 0), rows, Table(*feuds, *worse))
    assert (costs <= before).all()
    assert after[:, 11].tolist() == [2, 0, 0, 0]


@pytest.mark.parametrize(("rise", "taken"), [(0.09, [2, 2, 2, 2]), (0.5, [0, 2, 2, 2])])
def test_a_joint_that_stays_may_feel_its_neighbours_a_little(rise: float, taken: list[int]) -> None:
    """Joint 1, for which nothing better was found, costs a little more beside joint 0's best."""

    def costs(rows: np.ndarray) -> np.ndarray:
        found = 10.0 - rows[:, :, 11].astype(np.float64)
        found[:, 1] = np.where(rows[:, 0, 11] > 0, 10.0 + rise, 10.0)
        return np.asarray(found)

    after, _, _ = choose(marked(0, 0, 0, 0), np.stack([marked(2, 2, 2, 2), marked(1, 1, 1, 1)]), costs)
    assert [after[joint, 11] for joint in (0, 2, 3)] == [taken[joint] for joint in (0, 2, 3)]


def test_a_joint_that_fails_tries_the_best_three_others_and_then_those_without_integral() -> None:
    """Joint 2 fails with mark 5; rows 0 and 1 hold too little integral to swing."""
    rows = np.stack([marked(0, 0, mark, 0) for mark in (1, 2, 3, 5, 6, 4)])
    others = next_best(marked(1, 1, 5, 1), rows, 2, Table(), still=np.array([0, 1]))
    assert others[:, 11].tolist() == [6, 4, 3, 1, 2]
