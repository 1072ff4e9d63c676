"""Rattle, chatter and ripple of simulated candidates, slowly in numpy: the reference of host/native/score."""

from __future__ import annotations

import numpy as np
import scipy

from greywhale import _native
from greywhale.base.types import Floats, Integers
from greywhale.measure.swings import (
    BLOCK,
    BLOCK_S,
    CHATTER_SHARE,
    FILTER_EVERY,
    REACT_S,
    RIPPLE_S,
    SECTIONS,
    Duties,
    Singles,
    count_swings,
)
from greywhale.protocol.firmware import TICK_S, pwm_steps
from greywhale.protocol.schema import Board


def rattle(angles: Singles, leader: Floats, every: int, wait_s: float) -> Floats:
    """The rattle (n, 4) in rad, rms over the motion, of simulated followers (n, rows, 4).

    The power is compared block by block with the highest that the leader had in the last REACT_S. The angles have a row
    every `every` ticks, a divisor of FILTER_EVERY. `leader` (ticks, 4) has one every tick. What happens in the first
    `wait_s`, before the leader moves, is left out.
    """
    if FILTER_EVERY % every:
        raise ValueError(f"there is a row every {every} ticks, but {FILTER_EVERY} must be a multiple of that")
    followed = np.asarray(_native.band_power(angles, FILTER_EVERY // every, BLOCK, SECTIONS))
    led = np.asarray(_native.band_power(leader[None], FILTER_EVERY, BLOCK, SECTIONS))
    back = round(REACT_S / BLOCK_S)
    # The filter is centred; shifted, it looks back only.
    allowed = scipy.ndimage.maximum_filter1d(led, back + 1, axis=1, origin=back // 2)
    excess = np.maximum(followed - allowed, 0.0)[:, round(wait_s / BLOCK_S) :]
    return np.asarray(np.sqrt(excess.mean(axis=1)))


def duty_swings(duties: Duties, rows: tuple[int, int], board: Board) -> Integers:
    """For every record and joint (n, 4): swings by more than CHATTER_SHARE of that joint's full PWM."""
    steps = pwm_steps(board)
    counted = {top: count_swings(duties, *rows, CHATTER_SHARE * top)[0] for top in set(steps)}
    return np.stack([counted[top][:, joint] for joint, top in enumerate(steps)], axis=1)


def chatter(duties: Duties, every: int, board: Board) -> Floats:
    """Duty swings a second (n, 4) over whole records with a row every `every` ticks."""
    rows = duties.shape[1]
    found: Floats = duty_swings(duties, (0, rows), board) / (rows * every * TICK_S)
    return found


def ripple(duties: Duties, rows: tuple[int, int], board: Board) -> Floats:
    """The ripple of every record and joint (n, 4), as a share of the supply; a row a tick."""
    size = round(RIPPLE_S / TICK_S)
    path = duties[:, rows[0] : rows[1]].astype(np.float64)
    means = np.lib.stride_tricks.sliding_window_view(path, size, axis=1).mean(axis=-1)
    less = path[:, size // 2 : size // 2 + means.shape[1]] - means
    return np.asarray(np.sqrt(np.mean(less**2, axis=1)) / np.array(pwm_steps(board)))
