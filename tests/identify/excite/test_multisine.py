"""Whatever the numbers, a multi-sine keeps its ranges, speeds and accelerations, and is at rest at both ends."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from greywhale.identify.excite.limits import Limits
from greywhale.identify.excite.multisine import Shape, board_reference
from greywhale.protocol.firmware import POINT_S

LIMITS = Limits(
    pose=np.array([0.0, 0.9, -0.3, 1.0]),
    low=np.array([-1.0, -0.5, -0.3, -1.1]),
    high=np.array([1.0, 0.9, 0.1, 1.2]),
    speed=np.array([3.0, 2.0, 1.0, 0.5]),
    acceleration=np.array([20.0, 30.0, 8.0, 4.0]),
    lag=0.36,
)


def numbers() -> st.SearchStrategy[np.ndarray]:
    seeds, spans = st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.3, 1.0, 50.0])
    return st.tuples(seeds, spans).map(lambda one: np.random.default_rng(one[0]).uniform(-one[1], one[1], 48))


@settings(max_examples=40, deadline=None)
@given(shape=st.floats(4.0, 25.0).map(lambda seconds: Shape(LIMITS, seconds)), vector=numbers())
def test_ranges_speeds_accelerations_and_rest_at_both_ends_are_kept(shape: Shape, vector: np.ndarray) -> None:
    angles = shape.angles(vector)
    assert np.isfinite(angles).all()
    assert (angles >= LIMITS.low - 1e-12).all()
    assert (angles <= LIMITS.high + 1e-12).all()
    assert (np.abs(np.diff(angles, axis=0)) / POINT_S <= LIMITS.speed * (1 + 1e-9)).all()
    assert (np.abs(np.diff(angles, 2, axis=0)) / POINT_S**2 <= LIMITS.acceleration * (1 + 1e-9)).all()
    assert np.array_equal(angles[:10], np.tile(LIMITS.pose, (10, 1)))
    assert np.allclose(angles[-10:], LIMITS.pose, atol=1e-12)


def test_a_joint_uses_its_range_where_speed_allows_it() -> None:
    slow = Shape(Limits(*(LIMITS.pose, LIMITS.low, LIMITS.high), np.full(4, 50.0), np.full(4, 1e4), 0.36), 20.0)
    angles = slow.angles(np.random.default_rng(3).uniform(-1, 1, slow.size))
    assert (np.ptp(angles, axis=0) > 0.8 * (LIMITS.high - LIMITS.low)).all()


def test_no_two_joints_share_a_frequency() -> None:
    frequencies = np.sort(Shape(LIMITS, 20.0).frequencies.ravel())
    assert (np.diff(frequencies) / frequencies[:-1] > 0.05).all()
    assert frequencies[0] >= 0.1
    assert frequencies[-1] <= 3.0


def test_the_boards_curve_is_smooth_and_stays_in_the_hull_of_its_points() -> None:
    points = np.random.default_rng(5).uniform(-1, 1, (60, 4)).cumsum(axis=0) / 20
    curve = board_reference(points)
    assert len(curve) == 60 * 16
    rows = np.repeat(np.arange(60), 16)
    padded = np.vstack([points[:1], points, points[-1:]])
    near = np.stack([padded[rows], padded[rows + 1], padded[np.minimum(rows + 2, 61)]])
    assert (curve >= near.min(axis=0) - 1e-12).all()
    assert (curve <= near.max(axis=0) + 1e-12).all()
    speed = np.diff(curve, axis=0) / 1e-3
    largest = np.abs(np.diff(points, axis=0)).max(axis=0) / POINT_S
    assert (np.abs(speed) <= largest * (1 + 1e-9)).all()
    bend = np.abs(np.diff(points, 2, axis=0)).max(axis=0) / POINT_S**2
    bend = np.maximum(bend, np.abs(np.diff(points, axis=0))[[0, -1]].max(axis=0) / POINT_S**2)  # its rest at the ends
    assert (np.abs(np.diff(speed, axis=0)) / 1e-3 <= bend * (1 + 1e-6)).all()


def test_now_and_then_everything_stands_still() -> None:
    shape = Shape(LIMITS, 20.0)
    angles = shape.angles(np.random.default_rng(7).uniform(-1, 1, shape.size))
    still = (np.abs(np.diff(angles, axis=0)) < 1e-12).all(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(int)))
    lengths = (edges[1::2] - edges[::2]) * POINT_S
    assert (lengths[1:-1] > 0.5).all()
    assert len(lengths) == 4 + 2, "four pauses, and the ends"
