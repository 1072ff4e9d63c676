"""A sweep by hand: direction and ends, and each mistake by its name."""

from __future__ import annotations

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


@pytest.mark.parametrize("pot", range(8))
@pytest.mark.parametrize("sign", [1, -1])
def test_a_good_sweep_gives_direction_and_ends(pot: int, sign: int) -> None:
    found = judge_sweep(swept(pot, sign * 250.0), pot)
    assert found.mistakes == ()
    assert found.direction == sign
    assert (found.low, found.high) == pytest.approx((262.0, 762.0), abs=3.0)


def mistake(counts: np.ndarray, pot: int) -> str:
    (told,) = judge_sweep(counts, pot).mistakes
    return told


def test_swapped_wires_name_the_one_that_moved() -> None:
    told = mistake(swept(2), 0)
    assert told.startswith("Leader potentiometer 0 reads")
    assert "leader potentiometer 2 did: their wires are swapped" in told


def test_swapped_arms_are_told() -> None:
    assert "follower potentiometer 1 did: the two arms are swapped" in mistake(swept(5), 1)


def test_a_frozen_one_and_one_at_a_rail_differ() -> None:
    still = swept(0, 0.0)
    assert "check that its shaft turns with the joint" in mistake(still, 0)
    still[:, 0] = 0.0
    assert "at a rail" in mistake(still, 0)
    still[:, 0] = 1023.0
    assert "at a rail" in mistake(still, 0)


def test_two_that_move_together_are_told() -> None:
    counts = swept(3)
    counts[:, 6] += 200.0 * WAY
    assert "so did follower potentiometer 2" in mistake(counts, 3)


def test_the_dead_zone_within_the_range_is_told() -> None:
    counts = swept(4)
    counts[:, 4] = (counts[:, 4] + 400.0) % 1024.0
    assert "its dead zone lies there" in mistake(counts, 4)


def test_another_one_that_jumps_across_its_dead_zone_at_rest_is_named_itself() -> None:
    counts = swept(0)
    counts[::2, 5] = 1023.0
    counts[1500:1700, 5] = 0.0
    counts[:1500, 5] = 1023.0
    told = mistake(counts, 0)
    assert told.startswith("Follower potentiometer 1 jumps")
    assert "its dead zone lies there" in told


def test_a_track_that_ends_within_the_range_is_told() -> None:
    counts = swept(4, 400.0, 700.0)
    counts[:, 4] = np.minimum(counts[:, 4], 1023.0)
    assert "reaches an end of its track" in mistake(counts, 4)


def test_a_loose_contact_is_told_with_its_jumps() -> None:
    counts = swept(7)
    for row in (300, 700, 1500, 2000):
        counts[row : row + 2, 7] += 60.0
    assert "Follower potentiometer 3 jumped 4 times" in mistake(counts, 7)


def test_a_hand_that_stops_and_trembles_is_no_mistake() -> None:
    counts = swept(1)
    counts[:, 1] += 6.0 * np.sin(np.arange(ROWS) / 20.0)
    counts[:, 2] += 20.0 * WAY  # the neighbour gives a little
    assert judge_sweep(counts, 1).mistakes == ()
