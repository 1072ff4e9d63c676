"""Swings that nobody asked for: five words, and how each is measured. All of greywhale takes them from here; those of
simulated candidates are computed by host/native/score. From where on each counts is in `limits.py`.

- Hunting: while its leader rests, a joint turns back again and again, each time by more than a band (a gear that hunts
  in its backlash, an integrator that breaks loose, a loop without phase margin). `count_swings` counts the turns.
- Unrest: while its leader rests, the rms of the angle about its own mean over MEAN_S.
- Rattle: what the angle does at 6 to 40 Hz beyond what the leader does there (teeth that knock in their gap, friction
  that sticks and slips). A hand's own tremor is no rattle.
- Chatter: swings of the voltage by more than CHATTER_SHARE of its range, a second (a relay; noise that Kd magnifies).
- Ripple: the rms of the voltage less its own mean over RIPPLE_S: what is above some 20 Hz, which a motor does not
  follow. It hisses and warms up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt
import scipy  # loads a part of itself when it is first used

from greywhale import _native
from greywhale.base.types import Floats, Integers
from greywhale.measure.runs import resting, stretches
from greywhale.protocol.firmware import JOINTS, TICK_S

Singles = npt.NDArray[np.float32]
Duties = npt.NDArray[np.int16]

MEAN_S = 0.2  # over which a motion without its swings is the mean
RATTLE_BAND_HZ = (6.0, 40.0)  # where swings are rattling
CHATTER_SHARE = 1 / 3  # of full PWM: a larger swing of the duty is chatter
RIPPLE_S = 0.025  # ripple is what a voltage does beyond its mean over this


@dataclass(frozen=True)
class Hunting:
    """The fewest turns, each more than a band (rad) from the last, that are hunting."""

    band_rad: float
    turns: int


# What nobody can overlook: while an arm is led, the motors go off.
VIOLENT = Hunting(0.03, 4)


def count_swings(traces: Singles | Duties, first: int, last: int, band: float) -> tuple[Integers, Floats]:
    """Turning points of traces (n, rows, 4) more than `band` apart in rows first..last, and the way between: (n, 4)."""
    turned, moved = _native.swings(traces, first, last, band)
    return turned, moved


def turns_of(angles: Floats, band_rad: float, first: int = 0) -> Integers:
    """The turning points of one record (rows, 4) from row `first` on: (4,)."""
    path = np.ascontiguousarray(angles[None], dtype=np.float32)
    turned, _ = count_swings(path, first, path.shape[1], band_rad)
    found: Integers = turned[0]
    return found


END_S = 1.6  # growing swings of 1.5 Hz turn VIOLENT.turns times in it
JUMP_S = 0.02  # a reading that comes back sooner is a wiper's, no joint's


def turns_at_end(time_s: Floats, leader: Floats, follower: Floats) -> Integers:
    """Turns of VIOLENT size of followers (rows, 4), less those of their leaders, in a record's last END_S: (4,)."""
    if len(time_s) < 2:
        return np.zeros(JOINTS, dtype=np.intp)
    last = time_s > time_s[-1] - END_S
    row_s = float(np.median(np.diff(time_s[last])))
    size = (2 * round(0.5 * JUMP_S / row_s) + 1, 1)
    turned, led = (
        turns_of(scipy.ndimage.median_filter(angles[last], size, mode="nearest"), VIOLENT.band_rad)
        for angles in (follower, leader)
    )
    return turned - led


# --- unrest -----------------------------------------------------------------------------------------------------------

REST_AFTER_S = 0.7  # a follower may still be on its way for so long after its leader stopped
STILL_RAD = 0.005  # the leader rests within this
SHORTEST_REST_S = 0.3  # of a leader, for a rest to count


def smooth_motion(angles: Floats, row_s: float) -> Floats:
    """A motion (rows, 4) without its swings: its mean over MEAN_S."""
    size = max(3, round(MEAN_S / row_s))
    smooth: Floats = scipy.ndimage.uniform_filter1d(angles, size, axis=0, mode="nearest")
    return smooth


def unrest(leader: Floats, follower: Floats, still_rad: float = STILL_RAD) -> Floats:
    """(4,) rad rms over all rests; NaN for a joint whose leader never rests. A row a millisecond."""
    return _rms(_swings_at_rest(leader, follower, MEAN_S, still_rad))


def most_unrest(leader: Floats, follower: Floats) -> Floats:
    """Return the unrest (4,) of the worst rest (rad rms): swings that one pose or throw wakes are few among all."""
    found = _swings_at_rest(leader, follower, MEAN_S, STILL_RAD)
    return np.array([max((np.sqrt(np.mean(swing**2)) for swing in swings), default=np.nan) for swings in found])


def _rms(swings: Sequence[Sequence[Floats]]) -> Floats:
    """Of each joint's swings together; NaN for a joint without any."""
    return np.array([np.sqrt(np.mean(np.concatenate(some) ** 2)) if some else np.nan for some in swings])


def _swings_at_rest(leader: Floats, records: Floats, mean_s: float, still_rad: float) -> list[list[Floats]]:
    """Of each joint, the records (rows, 4) about their mean over `mean_s` in every rest of its leader."""
    found: list[list[Floats]] = []
    window, mean, least = (round(seconds / TICK_S) for seconds in (REST_AFTER_S, mean_s, SHORTEST_REST_S))
    for joint in range(JOINTS):
        rest = resting(leader[:, joint], window, still_rad)
        swings = []
        for first, last in stretches(rest):
            # A mean over samples of the next move would show that move.
            path = records[first : last - mean, joint]
            if len(path) >= least:
                swings.append(path - scipy.ndimage.uniform_filter1d(path, mean, mode="nearest"))
        found.append(swings)
    return found


# --- rattle -----------------------------------------------------------------------------------------------------------

# Ticks between the angles that a simulation filters: the band ends far below half of their rate.
FILTER_EVERY = 4
BLOCK_S = 0.1
# A quick move of the leader has all frequencies, and the slowest usual arm has answered it after this time.
REACT_S = 0.8

# scipy's butter(2, RATTLE_BAND_HZ, "bandpass"), rounded, so that it is the same filter on every computer, and nobody
# waits for scipy.signal.
SECTIONS = np.array(
    [
        [0.111982691551, 0.223965383102, 0.111982691551, 1.0, -0.830049306597, 0.369325623667],
        [1.0, -2.0, 1.0, 1.0, -1.798575677037, 0.824056907643],
    ]
)
BLOCK = round(BLOCK_S / (FILTER_EVERY * TICK_S))


def first_block(wait_s: float) -> int:
    """The first block of rattle after a wait."""
    return round(wait_s / BLOCK_S)


def rattle_of_record(leader: Floats, follower: Floats) -> Floats:
    """The rattle (4,) in rad, rms, of a record (rows, 4) in which a hand leads: nothing in it is quick."""
    from scipy.signal import sosfiltfilt  # slow to import

    powers = [np.mean(sosfiltfilt(_rattle_band(), angles, axis=0) ** 2, axis=0) for angles in (follower, leader)]
    beyond: Floats = np.sqrt(np.maximum(powers[0] - powers[1], 0.0))
    return beyond


@cache
def _rattle_band() -> Floats:
    from scipy.signal import butter  # slow to import

    band: Floats = butter(4, RATTLE_BAND_HZ, btype="bandpass", fs=1.0 / TICK_S, output="sos")
    return band


# --- chatter ----------------------------------------------------------------------------------------------------------


def chatter_of_record(voltage: Floats, supply_v: float) -> Floats:
    """Large swings of the voltage (rows, 4) a second: (4,)."""
    return turns_of(voltage, CHATTER_SHARE * supply_v) / (len(voltage) * TICK_S)


# --- ripple -----------------------------------------------------------------------------------------------------------


def ripple_of_record(voltage: Floats) -> Floats:
    """The ripple (4,) of a voltage (rows, 4), in its unit; a row a tick."""
    size = _ticks(RIPPLE_S)
    less = voltage - scipy.ndimage.uniform_filter1d(voltage, size, axis=0, mode="nearest")
    found: Floats = np.sqrt(np.mean(less[size // 2 : len(less) - size // 2] ** 2, axis=0))
    return found


def ripple_at_rest(leader: Floats, voltage: Floats, still_rad: float = STILL_RAD) -> Floats:
    """The ripple (4,) over all rests; NaN for a joint whose leader never rests. A row a millisecond."""
    return _rms(_swings_at_rest(leader, voltage, RIPPLE_S, still_rad))


def _ticks(seconds: float) -> int:
    return round(seconds / TICK_S)


# --- simulated candidates ---------------------------------------------------------------------------------------------

# In the order of SwingMeasure in host/native/score/swing_measure.h, which measures rattle, chatter and ripple of these.
FOR_SIMULATIONS: Floats = np.array(
    [*SECTIONS.ravel(), FILTER_EVERY, BLOCK, round(REACT_S / BLOCK_S), CHATTER_SHARE, _ticks(RIPPLE_S)]
)
