"""A sweep by hand: direction and ends, and each mistake by its name."""

from __future__ import annotations

import re

import numpy as np
import pytest

from greywhale.board.calibrate.sweep import judge_sweep

ROWS = 3000
WAY = np.interp(np.arange(ROWS), [0, 800, 1000, 2200, 2600, ROWS - 1], [0.0, 1.0, 1.0, -1.0, -1.0, 0.0])


def swept(pot: int, size: float = 250.0, middle: float = 512.0) -> np.ndarray:
    """All at rest but this one, with a count of noise."""
    counts: np.ndarray = np.full((ROWS, 8), 500.0) + np.random.default_rng(pot).normal(0.0, 0.5, (ROWS, 8))
    counts[:, pot] += middle - 500.0 + size * WAY
    return counts


@pytest.mark.parametrize(("pot", "sign"), [(0, 1), (3, -1), (4, -1), (7, 1)])
def test_a_good_sweep_gives_direction_and_ends(pot: int, sign: int) -> None:
    found = judge_sweep(swept(pot, sign * 250.0), pot)
    assert found.mistakes == ()
    assert found.direction == sign
    assert (found.low, found.high) == pytest.approx((262.0, 762.0), abs=3.0)


def changed(counts: np.ndarray, pot: int, values: object) -> np.ndarray:
    counts[:, pot] = values
    return counts


DEAD_ZONE = (swept(4)[:, 4] + 400.0) % 1024.0
JUMPING = np.where(
    np.arange(ROWS) < 1500, 1023.0, np.where(np.arange(ROWS) < 1700, 0.0, (np.arange(ROWS) % 2) * 523.0 + 500.0)
)
LOOSE = swept(7)[:, 7] + 60.0 * np.isin(np.arange(ROWS) // 2, (150, 350, 750, 1000))


MISTAKES = [
    (0, swept(2), "^Leader potentiometer 0 reads.*leader potentiometer 2 did: their wires"),
    (1, swept(5), "follower potentiometer 1 did: the two arms"),
    (0, swept(0, 0.0), "check that its shaft turns"),
    (0, changed(swept(0), 0, 0.0), "at a rail"),
    (0, changed(swept(0), 0, 1023.0), "at a rail"),
    (3, changed(swept(3), 6, 500.0 + 200.0 * WAY), "so did follower potentiometer 2"),
    (4, changed(swept(4), 4, DEAD_ZONE), "its dead zone"),
    (0, changed(swept(0), 5, JUMPING), "^Follower potentiometer 1 jumps.*its dead zone"),
    (4, np.minimum(swept(4, 400.0, 700.0), 1023.0), "an end of its track"),
    (7, changed(swept(7), 7, LOOSE), "Follower potentiometer 3 jumped 4 times"),
    (2, changed(swept(2), 2, 950.0 + 10.0 * WAY), "hardly changes near 5 V"),
]


@pytest.mark.parametrize(("pot", "counts", "words"), MISTAKES)
def test_each_mistake_is_told_by_its_name(pot: int, counts: np.ndarray, words: str) -> None:
    (told,) = judge_sweep(counts, pot).mistakes
    assert re.search(words, told), told


def test_a_hand_that_stops_and_trembles_is_no_mistake() -> None:
    counts = swept(1)
    counts[:, 1] += 6.0 * np.sin(np.arange(ROWS) / 20.0)
    counts[:, 2] += 20.0 * WAY  # the neighbour gives a little
    assert judge_sweep(counts, 1).mistakes == ()
