"""The three measures on signals whose answers are known by formula."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.files.log import Log
from greywhale.files.log.layout import Origin
from greywhale.measure import evaluate
from greywhale.measure.delay import correlations
from greywhale.measure.runs import gap_free_runs, last_part, resting

STEP = 0.5
TIME = np.arange(0, 10, 0.001)


def log(time: Floats, leader: Floats, follower: Floats, state: NDArray[np.str_] | None = None) -> Log:
    """The same motion on all four joints."""
    made = log_of(time, *(np.column_stack([one] * 4) for one in (leader, follower)))
    return made if state is None else replace(made, state=state)


def log_of(time: Floats, leader: Floats, follower: Floats) -> Log:
    """Of four joints, (rows, 4) each."""
    state = np.full(len(time), "following")
    return Log("test.csv", Origin(), time, leader, follower, np.zeros_like(leader), state, 0, True)


def reach(time: Floats, start: float, size: float = STEP, length: float = 0.4) -> Floats:
    """A minimum-jerk reach."""
    s = np.clip((time - start) / length, 0.0, 1.0)
    return np.asarray(size * (10 * s**3 - 15 * s**4 + 6 * s**5))


def motion(time: Floats) -> Floats:
    """Four reaches with rests between them."""
    return reach(time, 1.0) + reach(time, 3.0, 0.3) - reach(time, 5.0, 0.6) + reach(time, 7.0)


def test_mse_of_a_sine_error_is_half_its_square() -> None:
    leader = np.sin(2 * np.pi * TIME)
    result = evaluate(log(TIME, leader, leader - 0.2 * np.sin(2 * np.pi * 3 * TIME)))
    assert result.joints[0].mse == pytest.approx(0.02, rel=1e-6)
    assert result.total_mse == pytest.approx(4 * 0.02, rel=1e-6)  # the total is the sum, as in the paper's table 11
    assert result.joints[0].steady_state_error is None  # the leader never rests
    assert result.rests_s[0] == 0.0


@pytest.mark.parametrize(
    ("period", "delay", "gain", "offset"),
    [(0.001, 0.0137, 1.0, 0.0), (0.001, 0.75, 0.7, 0.3), (0.02, 0.0, 1.0, 0.0), (0.02, 0.0137, 0.7, 0.3)],
)
def test_the_delay_is_found_between_samples_whatever_gain_and_offset(
    period: float, delay: float, gain: float, offset: float
) -> None:
    time = np.arange(0, 10, period)
    result = evaluate(log(time, motion(time), gain * motion(time - delay) + offset))
    assert result.joints[0].delay_s == pytest.approx(delay, abs=0.0005)


@pytest.mark.slow
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.4))
@settings(max_examples=25, deadline=None)
def test_noise_moves_the_delay_by_little(seed: int, delay: float) -> None:
    random = np.random.default_rng(seed)
    time = np.arange(0, 10, 0.002)
    leader = motion(time) + random.normal(0, 0.005, len(time))
    follower = motion(time - delay) + random.normal(0, 0.005, len(time))
    assert evaluate(log(time, leader, follower)).joints[0].delay_s == pytest.approx(delay, abs=0.006)


def test_no_delay_is_claimed_where_there_is_none_to_see() -> None:
    noise = np.random.default_rng(1).normal(0, 0.003, len(TIME))
    still = evaluate(log(TIME, 0.2 + noise, 0.1 + noise)).joints[0]
    assert (still.delay_s, still.onset_delay_s) == (None, None)
    stuck = evaluate(log(TIME, motion(TIME), np.zeros_like(TIME))).joints[0]
    assert (stuck.delay_s, stuck.onset_delay_s, stuck.steps) == (None, None, 0)
    unrelated = evaluate(log(TIME, motion(TIME), np.sin(20 * TIME))).joints[0]
    assert unrelated.delay_s is None
    too_late = evaluate(log(TIME, motion(TIME), motion(TIME - 1.5))).joints[0]
    assert too_late.delay_s is None


def test_the_onset_delay_is_the_papers() -> None:
    joint = evaluate(log(TIME, motion(TIME), motion(TIME - 0.2345))).joints[0]
    assert joint.steps == 4
    assert joint.onset_delay_s == pytest.approx(0.2345, abs=0.0005)


def test_the_onset_delay_ignores_offsets_slow_drifts_and_small_moves() -> None:
    drift = 0.02 * TIME  # slower than a step, faster than a rest may be
    assert evaluate(log(TIME, drift, drift)).joints[0].steps == 0
    small = reach(TIME, 2.0, 0.1)
    assert evaluate(log(TIME, small, small)).joints[0].steps == 0
    step = reach(TIME, 2.0)
    joint = evaluate(log(TIME, step, 0.4 + reach(TIME - 0.1, 2.0))).joints[0]
    assert joint.steps == 1
    assert joint.onset_delay_s == pytest.approx(0.1, abs=0.0005)


def test_the_settling_error_is_the_mean_error_while_the_leader_has_rested() -> None:
    leader = motion(TIME)
    joint = evaluate(log(TIME, leader, 0.9 * leader)).joints[0]
    # Rests at 0, 0.5, 0.8, 0.2 and 0.7 rad; the error is a tenth of that. The first half second of a rest does not
    # count, so each weighs by the rest of its length.
    lengths = np.array([1.0 - 0.5, 2.0 - 0.9, 2.0 - 0.9, 2.0 - 0.9, 3.0 - 0.9])
    expected = float(lengths @ [0, 0.05, 0.08, 0.02, 0.07] / lengths.sum())
    assert joint.settling_error == pytest.approx(expected, rel=0.05)


def test_the_steady_state_error_is_that_of_the_final_position() -> None:
    leader, time = reach(TIME, 1.0, 1.0), TIME[:6000]
    follower = 0.9 * np.clip(leader - np.clip((3.5 - TIME) / 2.0, 0.0, 1.0) * (TIME > 1.0), 0.0, None)  # there at 3.5 s
    measured = log(time, leader[:6000], follower[:6000])
    joint = evaluate(measured).joints[0]
    # The rest at 0 follows no move.
    assert joint.steady_state_error == pytest.approx(0.1, rel=0.02)
    assert joint.settling_error is not None
    assert joint.settling_error > 0.15
    waiting = evaluate(log(TIME[:900], 0.0 * TIME[:900], 0.0 * TIME[:900] - 0.03)).joints[0]
    assert waiting.steady_state_error == pytest.approx(0.03)  # where there is no other rest, it counts


@given(st.lists(st.booleans(), min_size=1, max_size=60), st.integers(1, 20))
def test_the_last_part_of_a_rest_is_no_longer_than_its_window(values: list[bool], window: int) -> None:
    rest = np.array(values)
    expected = [
        here and any(rest[j] and not rest[j + 1 : j + 2].any() for j in range(k, min(k + window, len(rest))))
        for k, here in enumerate(rest)
    ]
    assert list(last_part(rest, window)) == expected


def test_tremor_within_the_band_is_rest_and_beyond_it_is_not() -> None:
    time = np.arange(0, 5, 0.001)
    tremor = np.sin(2 * np.pi * 9 * time)
    quiet = evaluate(log(time, 0.009 * tremor, 0.009 * tremor - 0.03))
    assert quiet.joints[0].steady_state_error == pytest.approx(0.03, rel=1e-3)
    assert quiet.rests_s[0] == pytest.approx(4.5, abs=0.01)
    assert evaluate(log(time, 0.011 * tremor, 0 * time)).joints[0].steady_state_error is None


def test_only_samples_in_following_count() -> None:
    state = np.where((TIME >= 2) & (TIME < 8), "following", "soft_start")
    leader = np.where(state == "following", 0.1, 3.0)
    result = evaluate(log(TIME, leader, 0 * TIME, state))
    assert result.joints[0].mse == pytest.approx(0.01)
    assert result.joints[0].steady_state_error == pytest.approx(0.1)
    assert (result.samples, result.following) == (6000, True)
    assert result.duration_s == pytest.approx(5.999)


def test_a_log_without_following_is_measured_whole_and_says_so() -> None:
    time = np.arange(0, 2, 0.001)
    result = evaluate(log(time, 0.1 + 0 * time, 0 * time, np.full(len(time), "disabled")))
    assert result.joints[0].mse == pytest.approx(0.01)
    assert not result.following
    assert "never followed" in str(result.as_dict()["measured"])


def test_a_gap_breaks_rests_and_delays_but_not_the_mean() -> None:
    keep = (TIME < 4.0) | (TIME > 4.4)
    whole = log(TIME, motion(TIME), motion(TIME - 0.1))
    gapped = evaluate(log(TIME[keep], motion(TIME)[keep], motion(TIME - 0.1)[keep]))
    assert gapped.joints[0].delay_s == pytest.approx(0.1, abs=0.002)
    assert gapped.rests_s[0] == pytest.approx(evaluate(whole).rests_s[0] - 0.4 - 0.5, abs=0.01)
    assert gapped.samples == keep.sum()
    assert (gapped.duration_s, gapped.span_s) == pytest.approx((9.597, 9.999))


@pytest.mark.parametrize("period", [1e-6, 1e9])
def test_any_period_that_a_log_may_have_is_measured(period: float) -> None:
    time = period * np.arange(9.0)
    led = np.where(np.arange(9) < 4, 0.0, 1.0)
    assert evaluate(log(time, led, led)).joints[0].mse == 0.0


def test_nothing_to_measure_is_said() -> None:
    time = np.arange(0, 1, 0.1)
    state = np.array(["following" if row == 5 else "disabled" for row in range(10)])
    with pytest.raises(UserError, match="nothing to measure"):
        evaluate(log(time, time, time, state))


@given(st.lists(st.tuples(st.sampled_from([1, 2, 5]), st.booleans()), min_size=2, max_size=40))
def test_runs_hold_every_wanted_neighbour_pair_once(steps: list[tuple[int, bool]]) -> None:
    time = np.cumsum([step for step, _ in steps]).astype(float)
    wanted = np.array([want for _, want in steps])
    runs = gap_free_runs(time, wanted)
    period = float(np.median(np.diff(time)))
    pairs = {k for run in runs for k in range(run.start, run.stop - 1)}
    expected = {
        k for k in range(len(time) - 1) if wanted[k] and wanted[k + 1] and time[k + 1] - time[k] <= 1.5 * period
    }
    assert pairs == expected
    assert sum(run.stop - run.start - 1 for run in runs) == len(pairs)


def test_the_delay_of_a_long_log_is_that_of_its_parts() -> None:
    """More samples than are transformed at once: every lag still meets all of its products."""
    time = np.arange(150_000) / 1000
    leader = np.sin(0.7 * time) + 0.3 * np.sin(2.9 * time)
    follower = np.sin(0.7 * (time - 0.123)) + 0.3 * np.sin(2.9 * (time - 0.123))
    assert evaluate(log(time, leader, follower)).joints[0].delay_s == pytest.approx(0.123, abs=1e-5)


@given(st.integers(0, 2**32 - 1), st.integers(1500, 70_000))
@settings(max_examples=20, deadline=None)
def test_correlations_are_pearsons(seed: int, length: int) -> None:
    """Against numpy's, at every lag: ends, means and scales of exactly the samples that both have."""
    random = np.random.default_rng(seed)
    a, b = random.normal(0.3, 1.0, length).cumsum(), random.normal(0.0, 1.0, length).cumsum()
    found = correlations(a, b, -100, 1000)
    for lag in (-100, -1, 0, 1, 999, 1000):
        one = a[: length - lag] if lag >= 0 else a[-lag:]
        other = b[lag:] if lag >= 0 else b[: length + lag]
        assert found[lag + 100] == pytest.approx(np.corrcoef(one, other)[0, 1], abs=1e-9)


def test_only_joints_in_use_count() -> None:
    time = np.arange(2000) / 1000
    leader = np.zeros((2000, 4))
    leader[:, :2] = np.sin(2.0 * time)[:, None]
    found = evaluate(replace(log_of(time, leader, 0.9 * leader), origin=Origin(joints=(0, 1))))
    assert found.joints_in_use == (0, 1)
    assert found.total_mse == pytest.approx(found.joints[0].mse + found.joints[1].mse)
    assert [joint["in_use"] for joint in found.as_dict()["joints"]] == [True, True, False, False]


def test_a_long_log_rests_where_its_parts_do() -> None:
    """Rests are found part by part; one across the border of two is none the less found."""
    angle = np.cumsum(np.random.default_rng(3).choice([0.0, 0.0, 0.0, 0.01], 600_000))
    rest = resting(angle, 8, 0.015)
    windows = np.lib.stride_tricks.sliding_window_view(angle, 9)
    np.testing.assert_array_equal(rest[8:], np.ptp(windows, axis=1) <= 0.015)
    assert not rest[:8].any()
