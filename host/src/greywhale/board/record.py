"""Records a board's samples into a log; with `enable`, the follower follows meanwhile.

The log begins with the first sample in state `following` (without `enable`: with the first sample). It is as long as
asked, by the board's clock. With a motion, which this host then leads, it is as long as the motion takes. Whatever ends
it early, the motors are stopped, and what was recorded is kept and marked as interrupted.
"""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, NotRequired, TypedDict

import numpy as np

from greywhale.base.errors import BadUsage, UserError, require_between
from greywhale.base.types import Floats, Progress, show_no_progress
from greywhale.board.device import Device
from greywhale.board.lead import Leading, Plan
from greywhale.board.limits import RECORDING
from greywhale.board.stream import Received, stream, why_stopped
from greywhale.board.upload import read_parameters
from greywhale.files.log.layout import Origin
from greywhale.files.log.writer import LogWriter
from greywhale.files.trajectory import Trajectory
from greywhale.protocol import schema
from greywhale.protocol.firmware import ANGLE_LSB
from greywhale.protocol.table import ParameterTable

Watch = Callable[[Received], None]

_ROWS_PER_REPORT = 50  # rows between two reports of progress
_MOVING = (schema.State.SOFT_START, schema.State.FOLLOWING)
_VOLT = schema.Sample.LSB["voltage"]


class RecordingFacts(TypedDict):
    log: str  # the file
    samples: int  # rows of the log
    dropped: int  # samples that the link lost
    duration_s: float  # by the board's clock
    gaps_s: NotRequired[list[Annotated[list[float], ("minItems", 2), ("maxItems", 2)]]]  # port away: when, how long


class LedRecordingFacts(RecordingFacts):
    slowest_pace: float  # of the motion that this host led; 1 is as planned
    waits: int  # how often the board had to wait for this host


@dataclass(frozen=True)
class Recording:
    """A recording's outcome: rows in the log, samples that the link lost, duration by the board's clock.

    `gaps` are those in which the port was away: when each began and its length, s.
    """

    path: Path
    rows: int
    dropped: int
    duration_s: float
    gaps: tuple[tuple[float, float], ...] = ()

    def as_dict(self) -> RecordingFacts:
        facts: RecordingFacts = {
            "log": str(self.path),
            "samples": self.rows,
            "dropped": self.dropped,
            "duration_s": self.duration_s,
        }
        if self.gaps:
            facts["gaps_s"] = [list(gap) for gap in self.gaps]
        return facts


@dataclass(frozen=True)
class LedRecording(Recording):
    """A motion that this host led: its slowest pace (1: as planned), and how often the board had to wait for it."""

    slowest: float = 1.0
    waits: int = 0

    def as_dict(self) -> LedRecordingFacts:
        return {**super().as_dict(), "slowest_pace": round(self.slowest, 2), "waits": self.waits}


def record(
    device: Device,
    path: str | Path,
    seconds: float,
    every: int = 1,
    enable: bool = False,
    progress: Progress = show_no_progress,
    disengaged: bool = False,
) -> Recording:
    """Record `seconds` of samples, one every `every` ticks of 1 ms; with `enable` perhaps `disengaged` first."""
    check_request(seconds, every, enable)
    origin = origin_of(device, read_parameters(device), every)
    length = round(seconds * 1000)
    with LogWriter(path, origin) as log:
        lease_ms = RECORDING.lease_ms if enable else 0
        with samples_of(device, every, lease_ms, disengaged, progress) as received:
            duration = write_samples(device, log, received, length, enable, progress)
    device.telemetry(0)
    return Recording(Path(path), log.rows, log.dropped, duration)


@contextlib.contextmanager
def samples_of(
    device: Device, every: int, lease_ms: int, disengaged: bool, progress: Progress
) -> Iterator[Iterator[Received]]:
    """The samples; with a lease those from the end of the soft start on, and the motors are off afterwards."""
    received = stream(device, every)
    if not lease_ms:
        yield received
        return
    if disengaged:
        device.clutch(schema.ClutchAction.DISENGAGE)
    with device.enabled(max(lease_ms, 20 * every)):
        yield _await_following(device, received, progress)


def record_led(
    device: Device,
    path: str | Path,
    motion: Trajectory,
    every: int = 1,
    progress: Progress = show_no_progress,
    table: ParameterTable | None = None,
    *,
    patient: bool = True,
    watch: Watch | None = None,
    lease_ms: int = RECORDING.lease_ms,
) -> LedRecording:
    """Lead the arm along `motion`, from where it is, and record that; `table` is the table that runs, where it is
    known.

    A `patient` host slows the motion down for a follower that lags; another does not, so that all controllers are led
    along the same motion. `watch` sees every sample of the log, and what it raises ends the recording, motors off.
    Where this host falls silent, they go off after `lease_ms`.
    """
    check_every_led(every)
    running = read_parameters(device, progress) if table is None else table
    limits = np.array(running.limits_raw()) * ANGLE_LSB
    Plan.of(motion, motion.angles[0], limits)  # too fast a motion is refused with the motors off
    origin = origin_of(device, running, every)
    with LogWriter(path, origin) as log:
        received = stream(device, every)
        with device.leading(lease_ms) as begun:
            pose = np.array(begun.reference) * ANGLE_LSB
            plan = Plan.of(motion, pose, limits, RECORDING.rest_s)
            leading = Leading(device, begun, plan, running.physical("tracking_limit") if patient else 0.0)
            received = _await_following(device, received, progress, leading)
            duration = _write_led(device, log, received, leading, progress, watch)
    device.telemetry(0)
    return LedRecording(Path(path), log.rows, log.dropped, duration, (), leading.slowest, leading.starved)


def check_every_led(every: int) -> None:
    """Refuse samples that are too rare to lead by."""
    if not 1 <= every <= RECORDING.longest_every_led_ticks:
        raise BadUsage(
            f"one sample every {every} ticks is out of range; while this host leads it must be 1 to "
            f"{RECORDING.longest_every_led_ticks}."
        )


def pose_of(device: Device) -> Floats:
    """The followers' angles now (4,), rad: the median of a few samples."""
    received = stream(device, 1)
    angles = [next(received).sample.follower for _ in range(21)]
    device.telemetry(0)
    pose: Floats = np.median(np.array(angles), axis=0) * ANGLE_LSB
    return pose


def check_request(seconds: float, every: int, enable: bool) -> None:
    """Refuse a length, or samples so rare, that no board can record."""
    require_between("the duration", seconds, "s", (RECORDING.shortest_s, RECORDING.longest_s))
    longest = RECORDING.longest_every_enabled_ticks if enable else RECORDING.longest_every_ticks
    if not 1 <= every <= longest:
        motors = " while the motors are on" if enable else ""
        raise BadUsage(f"one sample every {every} ticks is out of range; it must be 1 to {longest}{motors}.")


def origin_of(device: Device, running: ParameterTable, every: int) -> Origin:
    """The log's header. A table that is given is in it only if it is what the board runs."""
    crc = device.hello.param_crc
    table = running if running.crc == crc else None
    return Origin(
        device.firmware_version,
        device.hello.board.key,
        crc,
        running.period_ms,
        every,
        table,
        running.joints_in_use,
    )


def _await_following(
    device: Device, received: Iterator[Received], report: Progress, leading: Leading | None = None
) -> Iterator[Received]:
    """Wait until the soft start is over, and yield the samples from then on."""
    report("starting the motors", 0.0)
    moved = False
    for one in received:
        state = one.sample.state
        if state is schema.State.FOLLOWING:
            return itertools.chain((one,), received)
        if state is schema.State.SOFT_START:
            moved = True
            if leading is not None:
                leading.keep_ahead(one.elapsed, one.sample)
        # Samples from before the request may still arrive, but not for long.
        if state is schema.State.FAULT or (state not in _MOVING and (moved or one.elapsed > RECORDING.enable_ticks)):
            raise why_stopped(device)
    raise AssertionError("a stream of samples has no end")


def write_samples(
    device: Device,
    log: LogWriter,
    received: Iterator[Received],
    length: int,
    enabled: bool,
    report: Progress,
    begin: int = 0,
    ended: Callable[[], bool] = lambda: False,
) -> float:
    """Fill the log up to `length` ticks, with the first sample at the tick `begin`, and return its duration in s.

    `ended` is asked at each sample, and may end it sooner.
    """
    start: int | None = None
    for one in received:
        if enabled and one.sample.state is not schema.State.FOLLOWING:
            raise why_stopped(device)
        ticks = begin if start is None else begin + one.elapsed - start
        if ended() and start is not None and ticks < length:
            log.drop(one.lost)
            return ticks / 1000
        if ticks >= length:
            _end(device, log, one, length)
            return length / 1000
        if start is None:
            start = one.elapsed
        else:
            log.drop(one.lost)
        _append(log, ticks / 1000, one.sample)
        if log.rows % _ROWS_PER_REPORT == 0:
            report("recording", ticks / length)
    raise AssertionError("a stream of samples has no end")


def _end(device: Device, log: LogWriter, one: Received, length: int) -> None:
    """Count the samples that were lost before the end; a log that lacks much of it is not what was asked for."""
    every = log.origin.every_ticks or 1
    lost = min(one.lost, max(0, length - 1 - round(1000 * log.last_s)) // every)
    log.drop(lost)
    if lost > RECORDING.most_lost_samples and lost * every > RECORDING.most_lost_share * length:
        raise UserError(
            f"{device.port}: the end of the recording was lost: after {log.last_s:g} of {length / 1000:g} s no sample "
            f"came for {(one.lost + 1) * every / 1000:g} s by the board's clock; check the cable and whether this "
            "computer slept, and record again."
        )


def _write_led(
    device: Device,
    log: LogWriter,
    received: Iterator[Received],
    leading: Leading,
    report: Progress,
    watch: Watch | None = None,
) -> float:
    """Fill the log until the motion is over, and return its duration in s."""
    start: int | None = None
    for one in received:
        if one.sample.state is not schema.State.FOLLOWING:
            raise why_stopped(device)
        if start is None:
            start = one.elapsed
        else:
            log.drop(one.lost)
        leading.keep_ahead(one.elapsed, one.sample)
        if leading.done:
            return (one.elapsed - start) / 1000
        _append(log, (one.elapsed - start) / 1000, one.sample)
        if watch is not None:
            watch(one)
        if log.rows % _ROWS_PER_REPORT == 0:
            report("recording", leading.fraction)
    raise AssertionError("a stream of samples has no end")


def _append(log: LogWriter, time_s: float, sample: schema.Sample) -> None:
    log.append(
        time_s,
        [value * ANGLE_LSB for value in sample.leader],
        [value * ANGLE_LSB for value in sample.follower],
        [value * _VOLT for value in sample.voltage],
        sample.state.key,
    )
