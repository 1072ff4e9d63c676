"""The curve between rows: through every row, smooth, never beyond its rows."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from greywhale.files.trajectory import POT_RANGE_RAD, Trajectory
from greywhale.protocol.firmware import JOINTS

ANGLES = st.integers(-24000, 24000).map(lambda count: count * (POT_RANGE_RAD / 24000))


@given(arrays(np.float64, (6, JOINTS), elements=ANGLES))
def test_curve_passes_through_rows_and_stays_between_them(angles: np.ndarray) -> None:
    times = np.array([0.0, 0.02, 0.04, 0.1, 0.5, 2.0])
    motion = Trajectory(times, angles)
    np.testing.assert_allclose(motion.at(times), angles, atol=1e-12)
    for row in range(5):
        between = motion.at(np.linspace(times[row], times[row + 1], 50))
        low = np.minimum(angles[row], angles[row + 1]) - 1e-12
        high = np.maximum(angles[row], angles[row + 1]) + 1e-12
        assert np.all((between >= low) & (between <= high))


def test_outside_its_time_a_motion_holds_its_ends() -> None:
    motion = Trajectory(np.array([0.0, 1.0]), np.array([[0.1] * JOINTS, [0.7] * JOINTS]))
    np.testing.assert_allclose(motion.at(np.array([-5.0, 0.0, 1.0, 9.0]))[:, 0], [0.1, 0.1, 0.7, 0.7])


def test_curve_has_no_corner_at_a_row() -> None:
    """A straight line from row to row would change its speed by 1 rad/s at the middle row."""
    motion = Trajectory(np.array([0.0, 1.0, 2.0]), np.repeat([[0.0], [0.5], [2.0]], JOINTS, axis=1))
    step = 1e-4
    before, at, after = motion.at(np.array([1.0 - step, 1.0, 1.0 + step]))[:, 0]
    assert abs((after - at) - (at - before)) / step < 0.01


@pytest.mark.parametrize(
    ("times", "angle"),
    [([0.0], 0.0), ([0.1, 0.2], 0.0), ([0.0, 0.0], 0.0), ([0.0, 1.0], 2.5), ([0.0, 1.0], float("nan"))],
)
def test_impossible_motions_are_refused(times: list[float], angle: float) -> None:
    with pytest.raises(ValueError, match="trajectory"):
        Trajectory(np.array(times), np.full((len(times), JOINTS), angle))
