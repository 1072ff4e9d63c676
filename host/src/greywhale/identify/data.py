"""A log made ready: the stretches in which the motors followed, the arm's state along them, and windows to simulate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from greywhale.arm.parameters import USUAL_TRACK_RAD
from greywhale.base.types import Floats
from greywhale.files.log import Log
from greywhale.files.log.driven import driven_rows, undriven
from greywhale.files.log.limits import MOTORS
from greywhale.identify.limits import IDENTIFICATION_LIMITS, DataLimits, IdentificationLimits
from greywhale.measure.runs import Run, gap_free_runs
from greywhale.protocol.firmware import CONVERSIONS, CONVERTER_COUNTS, JOINTS, TICK_S

# Longest steps of the integration in a window, s: for the search, and for the final fit (a light link moves through its
# gap in some milliseconds).
STEP_S = 1e-3
# Firmware: from a new sample to its voltage, and the mean age of a tick's four conversions (s).
ACTUATION_S = 0.3e-3
CONVERSION_S = 0.5e-3


@dataclass(frozen=True)
class Prepared:
    """One log, with what it shows about the motion."""

    log: Log
    runs: tuple[Run, ...]
    period: float  # s between rows
    delay: float  # s, age of a reading
    smooth: Floats  # rad, the follower without its noise
    velocity: Floats
    acceleration: Floats
    places: Floats  # in the potentiometers' play, see `Windows`
    noise: Floats  # rad, standard deviation of a reading, per joint
    moving: NDArray[np.bool_]  # per joint
    undriven: tuple[int, ...]  # joints without a voltage that changes
    limits: IdentificationLimits = IDENTIFICATION_LIMITS

    @property
    def shown(self) -> NDArray[np.bool_]:
        """True for each joint whose motion under its voltages the log shows, (4,)."""
        return self.moving & ~np.isin(np.arange(JOINTS), self.undriven)


@dataclass(frozen=True)
class Windows:
    """Short pieces of a log as the native simulation takes them; `part` 0 to fit, 1 held out."""

    first: NDArray[np.int64]
    rows: int
    every: int
    angles: Floats
    velocities: Floats
    led: NDArray[np.int64]  # rows before it through which the log leads the links
    log_angles: Floats  # in every row of the log, without noise
    log_velocities: Floats
    log_places: Floats  # without jumps
    places: Floats  # where each joint stands in its potentiometer's play: -1 or +1, by its last sure motion; 0 before
    measured: Floats  # (windows, rows kept, 4)
    time: Floats  # (rows kept,) from the window's start
    volts: Floats
    spacing: Floats
    substeps: int

    def repeated(self, times: int) -> Windows:
        """The windows so many times, one lot after the other, to be simulated at once."""
        angles, velocities, places = (np.tile(one, (times, 1)) for one in (self.angles, self.velocities, self.places))
        first, led, measured = (
            np.tile(self.first, times),
            np.tile(self.led, times),
            np.tile(self.measured, (times, 1, 1)),
        )
        return replace(
            self, first=first, angles=angles, velocities=velocities, led=led, places=places, measured=measured
        )


def part_of(count: int, per_block: int, held_out: bool, held_out_every: int) -> NDArray[np.intp]:
    """The rows or windows of `count` that are held out, or those that are not."""
    last = np.arange(count) // per_block % held_out_every == held_out_every - 1
    return np.flatnonzero(last if held_out else ~last)


def prepare(log: Log, filter_shift: int | None, judging: IdentificationLimits = IDENTIFICATION_LIMITS) -> Prepared:
    """Find the usable stretches. Velocities come from local quadratic fits, noise from the quietest moments."""
    limits = judging.data
    from scipy.signal import savgol_filter  # slow to import

    wanted = driven_rows(log)
    period = float(np.median(np.diff(log.time)))
    # Long enough for a window. A few rows may be missing or late, as voltages change little meanwhile.
    least = max(8, round(limits.window_s / period) + 2)
    whole = gap_free_runs(log.time, wanted, limits.longest_gap_s)
    runs = tuple(one for one in whole if one.stop - one.start >= least)
    size = max(5, 2 * round(limits.smoothing_s / period / 2) + 1)
    velocity, acceleration, smooth = (np.zeros_like(log.follower) for _ in range(3))
    for run in runs:
        time = log.time[run.slice]
        even = np.linspace(time[0], time[-1], len(time))
        piece = at(even, time, log.follower[run.slice])
        for found, order in ((smooth, 0), (velocity, 1), (acceleration, 2)):
            found[run.slice] = at(time, even, savgol_filter(piece, size, 2, deriv=order, delta=run.period, axis=0))
    used = rows_in(runs, len(log.time))
    delay = 0.0 if filter_shift is None else CONVERSION_S + TICK_S * ((1 << filter_shift) - 1)
    noise = _noise(log.follower - smooth, used, size)
    least_rad = MOTORS.motion_rad
    moving = np.array([bool(used.any() and np.ptp(log.follower[used, joint]) > least_rad) for joint in range(JOINTS)])
    places = _places(velocity, runs, limits)
    still = undriven(log, used)
    return Prepared(log, runs, period, delay, smooth, velocity, acceleration, places, noise, moving, still, judging)


def in_brief(log: Prepared) -> Prepared:
    """The log with the short windows that gears are fitted to."""
    data = log.limits.data
    short = replace(data, window_s=data.gear_window_s, max_windows=data.max_gear_windows)
    return replace(log, limits=replace(log.limits, data=short))


def pot_noise(log: Prepared, filter_shift: int, supply: float) -> Floats:
    """The noise of the follower's four potentiometers, V rms, from the log's readings.

    A tuner that knows of none would choose a Kd that magnifies it. A reading is the sum of four conversions after the
    firmware's low-pass, which leaves share / (2 - share) of its input's variance. The converter's own steps make a part
    of the noise.
    """
    share = 1.0 / (1 << filter_shift)
    conversion = log.noise**2 * CONVERSIONS * (2.0 - share) / share
    analog = np.maximum(conversion - (USUAL_TRACK_RAD / CONVERTER_COUNTS) ** 2 / 12.0, 0.0)
    return np.sqrt(analog) / USUAL_TRACK_RAD * supply


def rows_in(runs: Sequence[Run], count: int) -> NDArray[np.bool_]:
    """True for each of `count` rows that lies in one of the runs."""
    used = np.zeros(count, dtype=bool)
    for run in runs:
        used[run.slice] = True
    return used


def _places(velocity: Floats, runs: tuple[Run, ...], limits: DataLimits) -> Floats:
    """The direction of the last motion that was sure, within each stretch."""
    places = np.zeros_like(velocity)
    for run in runs:
        speed = velocity[run.slice]
        last = np.where(np.abs(speed) > limits.sure_rad_s, np.arange(len(speed))[:, None], -1)
        last = np.maximum.accumulate(last, axis=0)
        places[run.slice] = np.where(last >= 0, np.sign(np.take_along_axis(speed, np.maximum(last, 0), axis=0)), 0.0)
    return places


def at(times: Floats, known: Floats, angles: Floats) -> Floats:
    """Each joint's values (rows, 4) between the known times, (times, 4)."""
    return np.column_stack([np.interp(times, known, angles[:, joint]) for joint in range(JOINTS)])


def _noise(rest: Floats, used: NDArray[np.bool_], size: int) -> Floats:
    """Standard deviation per joint, from the quieter half of short pieces, so that motion is not taken for noise."""
    kept = rest[used]
    count = len(kept) // size
    if count == 0:
        return np.full(JOINTS, 1e-3)
    pieces = kept[: count * size].reshape(count, size, JOINTS)
    # A quadratic fit takes away about a ninth of the variance.
    noise: Floats = np.maximum(np.sqrt(np.median(pieces.var(axis=1), axis=0)) * 1.06, 2e-4)
    return noise


def first_rows(prepared: Prepared) -> NDArray[np.int64]:
    """The first row of each window of a log, (windows,)."""
    rows = _rows_of_window(prepared)
    starts = [start for run in prepared.runs for start in range(run.start, run.stop - rows, rows)]
    return np.array(starts, dtype=np.int64)


def some_windows(logs: Sequence[Prepared], most: int) -> list[NDArray[np.intp]]:
    """At most about `most` windows of all logs together: numbers of windows, for each log.

    Where there are more, windows in which nothing moves go first, and what is left is taken evenly.
    """
    counts = [len(first_rows(log)) for log in logs]
    chosen = [np.arange(count) for count in counts]
    if sum(counts) <= most:
        return chosen
    lively = [np.flatnonzero(_is_lively(log)) for log in logs]
    if sum(map(len, lively)) >= most:
        chosen = lively
    share = most / max(1, sum(map(len, chosen)))
    return [_evenly(numbers, max(1, round(min(1.0, share) * len(numbers)))) for numbers in chosen]


def _evenly(numbers: NDArray[np.intp], count: int) -> NDArray[np.intp]:
    places = np.round(np.linspace(0, len(numbers) - 1, count)).astype(np.intp)
    return numbers[places] if len(numbers) else numbers


def _is_lively(prepared: Prepared) -> NDArray[np.bool_]:
    """True for each window in which any joint moves, (windows,)."""
    rows = _rows_of_window(prepared)
    angles, lively = prepared.log.follower, prepared.limits.data.lively_rad
    found = [float(np.ptp(angles[first : first + rows], axis=0).max()) > lively for first in first_rows(prepared)]
    return np.array(found, dtype=bool)


def _rows_of_window(prepared: Prepared) -> int:
    return max(6, round(prepared.limits.data.window_s / prepared.period))


def windows_of(
    prepared: Prepared,
    part: slice | NDArray[np.intp] | None = None,
    longest_step: float = STEP_S,
) -> Windows:
    """Windows one after the other over the whole log, or over a `part` of its windows."""
    rows, limits = _rows_of_window(prepared), prepared.limits.data
    every = max(1, round(limits.compared_s / prepared.period))
    first = first_rows(prepared)
    if part is not None:
        first = np.ascontiguousarray(first[part])
    log = prepared.log
    kept = np.arange(0, rows, every)
    at = first[:, None] + kept[None, :]
    spacing = np.diff(log.time, append=log.time[-1] + prepared.period)
    # Rounded, so that windows of even rows can share a processor's vector. Between stretches nothing is simulated.
    longest = max(1.5 * prepared.period, limits.longest_gap_s)
    spacing = np.round(np.minimum(spacing, longest), 9).astype(np.float64)
    substeps = max(1, int(np.ceil(np.percentile(spacing, limits.usual_spacings) / longest_step - 1e-6)))
    return Windows(
        first=first,
        rows=rows,
        every=every,
        angles=np.ascontiguousarray(_start_angles(prepared, first)),
        velocities=np.ascontiguousarray(prepared.velocity[first]),
        led=_led(prepared, first),
        places=np.ascontiguousarray(prepared.places[first]),
        measured=log.follower[at],
        time=np.asarray(kept * prepared.period, dtype=np.float64),
        volts=_volts(prepared, substeps, spacing),
        spacing=np.ascontiguousarray(spacing),
        substeps=substeps,
        log_angles=prepared.smooth,
        log_velocities=prepared.velocity,
        log_places=_smooth_places(prepared),
    )


def _led(prepared: Prepared, first: NDArray[np.int64]) -> NDArray[np.int64]:
    """The rows of the log before each window by which its motors are led, within its stretch."""
    begins = np.array([run.start for run in prepared.runs], dtype=np.int64)
    most = round(prepared.limits.data.led_s / prepared.period)
    led: NDArray[np.int64] = np.minimum(most, first - begins[np.searchsorted(begins, first, side="right") - 1])
    return np.ascontiguousarray(led)


def _smooth_places(prepared: Prepared) -> Floats:
    """The places in the play of every row; at a turn the joint takes a moment to cross the play."""
    from scipy.ndimage import uniform_filter1d  # slow to import

    size = max(1, round(prepared.limits.data.smoothing_s / prepared.period))
    places: Floats = uniform_filter1d(prepared.places, size, axis=0)
    return places


def _start_angles(prepared: Prepared, first: NDArray[np.int64]) -> Floats:
    """The smoothed angle at each window's start: the mean over +-2 rows, without what curvature adds to it."""
    follower = prepared.log.follower
    around = np.clip(first[:, None] + np.arange(-2, 3)[None, :], 0, len(follower) - 1)
    bend: Floats = prepared.acceleration[first] * (prepared.period**2) * 2.0 / 2.0
    angles: Floats = follower[around].mean(axis=1) - bend
    return angles


def _volts(prepared: Prepared, substeps: int, spacing: Floats) -> Floats:
    """The voltage in every substep: what the board held then, or a line between rows in a log with few rows."""
    log = prepared.log
    share = (np.arange(substeps) + 0.5) / substeps
    moments = (log.time[:, None] + share[None, :] * spacing[:, None]).ravel() - prepared.delay - ACTUATION_S
    period_ms = log.origin.period_ms or 0
    if prepared.period > 1.5e-3 * max(period_ms, 1):
        return at(moments, log.time, log.voltage)
    held = np.clip(np.searchsorted(log.time, moments + 1e-9, side="right") - 1, 0, len(log.time) - 1)
    volts = log.voltage[held]
    # Where rows are missing, the line between their neighbours is the better guess.
    missing = np.repeat(spacing > 1.5 * prepared.period, substeps)
    if missing.any():
        volts[missing] = at(moments[missing], log.time, log.voltage)
    return np.ascontiguousarray(volts)
