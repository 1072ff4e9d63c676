"""How much a follower rattles and its duty chatters while the leader moves, not only at rest.

Rattling is what the follower's angle does at 6 to 40 Hz beyond what the leader does there: gear teeth that knock in
their gap, a loop near its margin of phase, friction that sticks and slips. A hand's own tremor is no rattling, and
neither is a quick move of the leader, which the follower answers within REACT_S with all frequencies. So the power of
the follower in the band is compared, block by block, with the highest that the leader had in the last REACT_S.

Chatter is a duty that swings by more than CHATTER_SHARE of its range, counted over the whole motion.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.ndimage import maximum_filter1d
from scipy.signal import butter

from greywhale.base.types import Floats, Integers
from greywhale.protocol.firmware import TICK_S, pwm_steps
from greywhale.protocol.schema import Board
from greywhale.simulate import Result
from greywhale.simulate.closed_loop import band_power, count_swings

BAND_HZ = (6.0, 40.0)
ORDER = 2
# Ticks between the angles that are filtered: the band ends far below half of their rate.
FILTER_EVERY = 4
BLOCK_S = 0.1
# The slowest usual arm has caught up with the leader after this time.
REACT_S = 0.8
CHATTER_SHARE = 1 / 3

# Rounded, so that it is the same filter on every computer.
SECTIONS = np.round(butter(ORDER, BAND_HZ, "bandpass", fs=1.0 / (FILTER_EVERY * TICK_S), output="sos"), 12)
BLOCK = round(BLOCK_S / (FILTER_EVERY * TICK_S))


def rattle(angles: npt.NDArray[np.float32], leader: Floats, every: int, wait_s: float) -> Floats:
    """The rattling (n, 4) in rad, rms over the motion, of followers' angles (n, rows, 4).

    The angles have a row every `every` ticks, a divisor of FILTER_EVERY. `leader` (ticks, 4) has one every tick. What
    happens in the first `wait_s`, before the leader moves, is left out.
    """
    if FILTER_EVERY % every:
        raise ValueError(f"there is a row every {every} ticks, but {FILTER_EVERY} must be a multiple of that")
    followed = band_power(angles, FILTER_EVERY // every, BLOCK, SECTIONS)
    led = band_power(leader[None], FILTER_EVERY, BLOCK, SECTIONS)
    back = round(REACT_S / BLOCK_S)
    # The filter is centred; shifted, it looks back only.
    allowed = maximum_filter1d(led, back + 1, axis=1, origin=back // 2)
    first = round(wait_s / BLOCK_S)
    excess = np.maximum(followed - allowed, 0.0)[:, first:]
    found: Floats = np.sqrt(excess.mean(axis=1))
    return found


def chatter(result: Result, every: int, board: Board) -> Floats:
    """Duty swings a second (n, 4) over a whole record with a row every `every` ticks."""
    rows = result.duties.shape[1]
    found: Floats = duty_swings(result, (0, rows), board) / (rows * every * TICK_S)
    return found


def duty_swings(result: Result, rows: tuple[int, int], board: Board) -> Integers:
    """For every row and joint (n, 4): swings by more than CHATTER_SHARE of that joint's full PWM."""
    steps = pwm_steps(board)
    counted = {top: count_swings(result.duties, *rows, CHATTER_SHARE * top)[0] for top in set(steps)}
    return np.stack([counted[top][:, joint] for joint, top in enumerate(steps)], axis=1)
