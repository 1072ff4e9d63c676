"""Rattling is what a follower does in a band beyond its leader. To follow a tremor or a quick move is none."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import sosfilt

from greywhale.files.arm import default_arm
from greywhale.motion import human_reaches
from greywhale.protocol.firmware import pwm_steps
from greywhale.protocol.schema import Board
from greywhale.simulate import Experiment, default_controller
from greywhale.simulate.closed_loop import band_power
from greywhale.tune.search.rattle import BLOCK, SECTIONS, chatter, duty_swings, rattle

TIME_S = np.arange(6000) * 1e-3


def wave(hz: float, size: float) -> np.ndarray:
    return np.tile((size * np.sin(2.0 * np.pi * hz * TIME_S))[:, None], 4)


def follower(*paths: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(np.sum(paths, axis=0)[None].astype(np.float32))


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_the_native_filter_is_scipys(kind: type) -> None:
    angles: np.ndarray = np.cumsum(np.random.default_rng(3).normal(size=(3, 803, 4)), axis=1).astype(kind)
    rows = (angles.astype(np.float64) - angles[:, :1].astype(np.float64))[:, ::2]
    blocks = rows.shape[1] // BLOCK
    wanted = np.square(sosfilt(SECTIONS, rows, axis=1))[:, : blocks * BLOCK].reshape(3, blocks, BLOCK, 4).mean(axis=2)
    np.testing.assert_allclose(band_power(angles, 2, BLOCK, SECTIONS), wanted, rtol=1e-9)


def test_swinging_in_the_band_is_rattling_and_elsewhere_is_not() -> None:
    slow = wave(0.4, 0.3)
    for hz, size, low, high in ((10.0, 0.004, 0.85, 1.1), (20.0, 0.004, 0.85, 1.1), (2.0, 0.004, 0.0, 0.15)):
        found = rattle(follower(slow, wave(hz, size)), slow, 1, 0.2)
        assert (found >= low * size / np.sqrt(2.0)).all(), hz
        assert (found <= high * size / np.sqrt(2.0)).all(), hz


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
    result = Experiment(human_reaches(1, 4.0), default_arm()).run(default_controller()[None], every=1)
    half = pwm_steps(Board.NANO328)[3] // 2
    square = np.where(np.arange(len(TIME_S)) % 10 < 5, half, 0).astype(np.int16)
    result = type(result)(**{**vars(result), "duties": np.ascontiguousarray(np.tile(square[None, :, None], (1, 1, 4)))})
    mega, nano = (chatter(result, 1, board)[0] for board in (Board.MEGA2560, Board.NANO328))
    assert (mega[:2] == nano[:2]).all()
    assert nano[3] == pytest.approx(200.0, rel=0.01)
    assert mega[3] == 0.0
    assert duty_swings(result, (0, 100), Board.NANO328).shape == (1, 4)
