"""Unrest, rattle, chatter and ripple of motions made by hand. To follow a tremor or a quick move is none of them.

Of simulated candidates tests/support/swings.py measures them; tests/tune/test_reference.py compares it with what runs.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from greywhale import _native
from greywhale.measure.swings import (
    BLOCK,
    FILTER_EVERY,
    RATTLE_BAND_HZ,
    SECTIONS,
    chatter_of_record,
    most_unrest,
    rattle_of_record,
    ripple_of_record,
    turns_at_end,
    unrest,
)
from greywhale.protocol.firmware import TICK_S, pwm_steps
from greywhale.protocol.schema import Board
from tests.support.swings import chatter, duty_swings, rattle, ripple

TIME_S = np.arange(6000, dtype=np.float64) * np.float64(1e-3)


def wave(hz: float, size: float) -> np.ndarray:
    return np.tile((size * np.sin(2.0 * np.pi * hz * TIME_S))[:, None], 4)


def follower(*paths: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(np.sum(paths, axis=0)[None].astype(np.float32))


def test_the_bands_filter_is_scipys() -> None:
    wanted = butter(2, RATTLE_BAND_HZ, "bandpass", fs=1.0 / (FILTER_EVERY * TICK_S), output="sos")
    np.testing.assert_allclose(SECTIONS, wanted, atol=6e-13)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_the_native_filter_is_scipys(kind: type) -> None:
    angles: np.ndarray = np.cumsum(np.random.default_rng(3).normal(size=(3, 803, 4)), axis=1).astype(kind)
    rows = (angles.astype(np.float64) - angles[:, :1].astype(np.float64))[:, ::2]
    blocks = rows.shape[1] // BLOCK
    wanted = np.square(sosfilt(SECTIONS, rows, axis=1))[:, : blocks * BLOCK].reshape(3, blocks, BLOCK, 4).mean(axis=2)
    found = np.asarray(_native.band_power(angles, 2, BLOCK, SECTIONS))
    np.testing.assert_allclose(found, wanted, rtol=1e-9)


def test_a_follower_that_does_as_its_leader_does_not_rattle() -> None:
    trembling = wave(0.4, 0.3) + wave(10.0, 0.002)
    late = np.concatenate([trembling[:1].repeat(20, axis=0), trembling[:-20]])
    assert (rattle(follower(late), trembling, 1, 0.2) < 1e-4).all()
    jump = np.tile(np.where(TIME_S < 2.0, 0.0, 1.0)[:, None], 4)
    slower = np.tile(np.clip((TIME_S - 2.0) / 0.2, 0.0, 1.0)[:, None], 4)
    assert (rattle(follower(slower), jump, 1, 0.2) < 1e-4).all()


def test_a_hunt_long_after_a_move_is_not_hidden_by_it() -> None:
    jump = np.tile(np.where(TIME_S < 2.0, 0.0, 1.0)[:, None], 4)
    hunting = np.where(TIME_S[:, None] > 3.5, wave(8.0, 0.01), 0.0)
    found = rattle(follower(jump, hunting), jump, 1, 0.2)
    assert (found > 0.9 * 0.01 / np.sqrt(2.0) * np.sqrt(2.5 / 5.8)).all()


def test_every_divisor_of_the_filters_rate_gives_the_same() -> None:
    slow = wave(0.4, 0.3)
    angles = follower(slow, wave(10.0, 0.004))
    found = [rattle(np.ascontiguousarray(angles[:, ::every]), slow, every, 0.2) for every in (1, 2, 4)]
    np.testing.assert_array_equal(found[0], found[1])
    np.testing.assert_array_equal(found[0], found[2])
    with pytest.raises(ValueError, match="a row every 3 ticks"):
        rattle(angles, slow, 3, 0.2)


def test_duties_are_counted_by_their_own_joints_range() -> None:
    """On a Nano two joints have a coarser PWM, so the same numbers are larger swings there."""
    half = pwm_steps(Board.NANO328)[3] // 2
    square = np.where(np.arange(len(TIME_S)) % 10 < 5, half, 0).astype(np.int16)
    duties = np.ascontiguousarray(np.tile(square[None, :, None], (1, 1, 4)))
    mega, nano = (chatter(duties, 1, board)[0] for board in (Board.MEGA2560, Board.NANO328))
    assert (mega[:2] == nano[:2]).all()
    assert nano[3] == pytest.approx(200.0, rel=0.01)
    assert mega[3] == 0.0
    assert duty_swings(duties, (0, 100), Board.NANO328).shape == (1, 4)


def staircase() -> np.ndarray:
    """A leader that moves for a moment every two seconds, all joints alike."""
    return np.tile((np.floor(TIME_S / 2.0) * 0.3)[:, None], (1, 4))


def tone(hertz: float, rms: float) -> np.ndarray:
    return np.asarray(rms * np.sqrt(2.0) * np.sin(2.0 * np.pi * hertz * TIME_S))


def test_unrest_is_what_the_follower_swings_while_its_leader_rests() -> None:
    leader = staircase()
    follower = leader.copy()
    follower[:, 1] += tone(7.0, 0.02)
    found = unrest(leader, follower)
    # The mean over 0.2 s keeps a fifth of a swing of 7 Hz.
    assert found[1] == pytest.approx(0.02, rel=0.3)
    assert found[[0, 2, 3]] == pytest.approx(np.zeros(3), abs=1e-12)


def test_the_most_unrest_is_that_of_the_worst_rest() -> None:
    """Of the rests in the record, joint 1 swings in the first alone."""
    leader = staircase()
    follower = leader.copy()
    follower[TIME_S < 2.0, 1] += tone(7.0, 0.02)[TIME_S < 2.0]
    found = most_unrest(leader, follower)
    assert found[1] == pytest.approx(0.02, rel=0.3)
    assert found[1] > 1.5 * unrest(leader, follower)[1]
    assert found[[0, 2, 3]] == pytest.approx(np.zeros(3), abs=1e-12)


def test_moving_is_no_unrest() -> None:
    """A slow follower still creeps when the leader has stopped, and the next move begins at the end of a rest."""
    leader = staircase()
    late = np.maximum(TIME_S % 2.0, 0.0)
    follower = leader - 0.3 * np.exp(-late / 0.15)[:, None]
    assert unrest(leader, follower).max() < 1e-3


def test_a_leader_that_never_rests_shows_no_unrest() -> None:
    leader = np.tile((0.3 * TIME_S)[:, None], (1, 4))
    assert np.isnan(unrest(leader, leader)).all()
    assert np.isnan(most_unrest(leader, leader)).all()


def test_rattle_is_what_the_follower_adds_between_6_and_40_hz() -> None:
    leader = np.tile(np.sin(TIME_S)[:, None], (1, 4))
    leader[:, 1] += tone(10.0, 0.002)
    follower = leader.copy()
    follower[:, 0] += tone(12.0, 0.004)
    follower[:, 2] += tone(1.0, 0.05)
    found = rattle_of_record(leader, follower)
    assert found[0] == pytest.approx(0.004, rel=0.05)
    assert found[1] == 0.0, "a hand's tremor that is followed is no rattling"
    assert found[2] < 5e-4
    assert found[3] == 0.0


def test_chatter_counts_large_swings_of_the_voltage() -> None:
    volts = np.zeros((2000, 4))
    volts[:, 0] = np.where(np.arange(2000) % 10 < 5, 6.0, -6.0)
    volts[:, 1] = np.where(np.arange(2000) % 10 < 5, 2.0, -2.0)
    found = chatter_of_record(volts, 15.0)
    assert found[0] == pytest.approx(200.0, rel=0.01)
    assert found[1] == 0.0


@pytest.mark.parametrize(("hz", "share"), [(2.0, 0.005), (200.0, 1.0)])
def test_ripple_is_what_the_voltage_does_beyond_its_mean_over_25_ms(hz: float, share: float) -> None:
    """Slow motion is none; a fast swing is all ripple, in a record in volts and in duties of any board."""
    voltage = 5.0 + wave(hz, 3.0)
    np.testing.assert_allclose(ripple_of_record(voltage), share * 3.0 / np.sqrt(2.0), atol=0.02)
    for board in (Board.MEGA2560, Board.NANO328):
        duties = np.round(voltage / 15.0 * np.array(pwm_steps(board))).astype(np.int16)[None]
        np.testing.assert_allclose(15.0 * ripple(duties, (0, 6000), board)[0], ripple_of_record(voltage), atol=0.03)


def test_growing_swings_turn_and_a_wiper_that_jumps_or_a_leader_that_is_followed_does_not() -> None:
    still, growing = wave(0.0, 0.0), wave(2.0, 0.1) * (TIME_S / TIME_S[-1])[:, None]
    jumping = np.where((np.arange(6000) % 100 < 8)[:, None], 0.5, still)
    led = wave(1.0, 0.3)
    late = np.roll(led, 150, axis=0)
    assert turns_at_end(TIME_S, still, growing).tolist() == [6] * 4
    assert turns_at_end(TIME_S[::4], still[::4], growing[::4]).tolist() == [6] * 4
    assert turns_at_end(TIME_S, still, jumping).tolist() == [0] * 4
    assert turns_at_end(TIME_S, led, late + 1e-3).max() <= 1
    assert turns_at_end(TIME_S[:1], still[:1], still[:1]).tolist() == [0] * 4
