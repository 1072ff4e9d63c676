"""Generated motions: human in speed, pauses and tremor; the paper's steps; the curve between rows."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.signal import butter, sosfiltfilt

from greywhale.files.trajectory import POT_RANGE_RAD, Trajectory
from greywhale.loop import human_reaches, multi_steps, steps
from greywhale.loop.leader_motions import RANGE_RAD, RATE_HZ, minimum_jerk
from greywhale.protocol.firmware import JOINTS

SEEDS = range(3)


def test_minimum_jerk_is_the_known_polynomial() -> None:
    s = np.linspace(0.0, 1.0, 11)
    np.testing.assert_allclose(minimum_jerk(s), 10 * s**3 - 15 * s**4 + 6 * s**5, atol=1e-15)
    assert minimum_jerk(np.array([-1.0, 2.0])).tolist() == [0.0, 1.0]


def test_same_seed_same_motion_other_seed_other_motion() -> None:
    first, again, other = human_reaches(4), human_reaches(4), human_reaches(5)
    assert np.array_equal(first.angles, again.angles)
    assert first.angles.shape != other.angles.shape or not np.allclose(first.angles, other.angles)


@pytest.mark.parametrize("seed", SEEDS)
def test_reaches_are_human(seed: int) -> None:
    motion = human_reaches(seed)
    assert 17.0 <= motion.duration_s <= 20.0
    margin = 0.02  # tremor
    assert np.all(motion.angles >= RANGE_RAD[:, 0] - margin)
    assert np.all(motion.angles <= RANGE_RAD[:, 1] + margin)
    intended = sosfiltfilt(butter(4, 5.0, fs=RATE_HZ, output="sos"), motion.angles, axis=0)
    speed = np.abs(np.gradient(intended, 1.0 / RATE_HZ, axis=0))
    assert 1.0 < speed.max() < 8.0, "an arm reaches at a few rad/s"
    begin, end = longest_rest(speed.max(axis=1) < 0.1)
    assert (end - begin) / RATE_HZ >= 0.6, "a steady state must be readable"


@pytest.mark.parametrize("seed", SEEDS)
def test_tremor_has_its_size_and_band(seed: int) -> None:
    motion = human_reaches(seed)
    tremor = sosfiltfilt(butter(4, (7.0, 13.0), "bandpass", fs=RATE_HZ, output="sos"), motion.angles, axis=0)
    begin, end = longest_rest(np.abs(np.gradient(motion.angles, axis=0)).max(axis=1) * RATE_HZ < 0.6)
    still = slice(begin + 20, end - 20)  # away from the reaches on both sides
    rms = np.sqrt(np.mean(tremor[still] ** 2, axis=0))
    assert np.all((rms > 0.0008) & (rms < 0.004)), rms
    fast = sosfiltfilt(butter(4, 20.0, "highpass", fs=RATE_HZ, output="sos"), motion.angles, axis=0)
    assert np.sqrt(np.mean(fast[still] ** 2)) < 0.0002, "nothing above the tremor's band"


def test_steps_reach_their_levels() -> None:
    motion = multi_steps([0.0, 1.0, -0.5], [1.0, 2.0, 2.0])
    assert motion.duration_s == 5.0
    at = motion.at(np.array([0.99, 1.04, 2.99, 3.04, 5.0]))
    np.testing.assert_allclose(at, np.repeat([[0.0], [1.0], [1.0], [-0.5], [-0.5]], 4, axis=1), atol=1e-9)
    one = steps(0.8)
    np.testing.assert_allclose(one.at(np.array([1.0, 1.04, 5.0]))[:, 2], [0.0, 0.8, 0.8], atol=1e-9)


def longest_rest(resting: np.ndarray) -> tuple[int, int]:
    """The rows where it begins and ends."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], resting.astype(int), [0])))).reshape(-1, 2)
    begin, end = edges[np.argmax(edges[:, 1] - edges[:, 0])]
    return int(begin), int(end)


def test_edges_keep_below_a_given_speed() -> None:
    fastest = 7.0
    motion = multi_steps(fastest_rad_s=fastest)
    speed = np.abs(np.diff(motion.angles[:, 0])) / np.diff(motion.time_s)
    assert 0.9 * fastest < speed.max() <= fastest
    assert np.allclose(motion.at(np.array([3.4]))[0], 1.0)  # and every level is still reached


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
