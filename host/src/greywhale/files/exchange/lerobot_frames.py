"""The frames of a LeRobot episode from a log: what the arm was asked and what it did, at whole frames a second.

A frame carries the last sample at or before its time. At 30 frames a second and 1 kHz that is frame i at the tick
floor(1000 i / 30), less than a millisecond before i/30 s; rates that divide 1000 (20, 25, 40, 50) fall on ticks. Beside
it stand all samples since the frame before, as a window. Nothing is filled in: an episode is the longest stretch of a
log in which no sample is missing and the motors follow all the time.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from greywhale.base.errors import UserError, counted
from greywhale.base.types import Floats
from greywhale.files.exchange.recording import Column, Recording
from greywhale.files.log import Log
from greywhale.protocol.joints import NAMES, Joints

Floats32 = NDArray[np.float32]

_TICKS_PER_S = 1000
_SHORT = {"follower": "pos"}
_LEAST_FRAMES = 2  # statistics need so many


def names_of(joints: Joints, quantity: str) -> list[str]:
    """The names of a quantity's components: yaw.pos. A position is in rad, a voltage in V."""
    return [f"{NAMES[joint]}.{quantity}" for joint in joints]


@dataclass(frozen=True)
class Form:
    """The form of an episode's frames, which all of a dataset have alike."""

    joints: Joints
    components: tuple[str, ...]  # of the state, such as yaw.pos
    every_ticks: int  # between two samples of a window
    samples: int  # of a window


@dataclass(frozen=True)
class Episode:
    """One log as frames, which are made when they are asked for; `remarks` say what of it is left out, a sentence each.

    An action has the leader's angles in rad; a state the follower's, the voltages in V, and what was computed. A window
    has the samples up to its frame's own, which is the last.
    """

    form: Form
    rows: slice  # of the log
    places: NDArray[np.int64]  # of each frame's first sample in these rows
    asked: Sequence[Column]
    seen: Sequence[Column]
    remarks: tuple[str, ...]

    def actions(self, frames: slice) -> Floats32:
        """The actions (frames, joints)."""
        return self._windows(self.asked, frames)[:, -1]

    def windows(self, frames: slice) -> Floats32:
        """The windows (frames, samples, components); the states are their last samples."""
        return self._windows(self.seen, frames)

    def _windows(self, columns: Sequence[Column], frames: slice) -> Floats32:
        places = self.places[frames]
        first = self.rows.start + places[0]
        rows = slice(first, self.rows.start + places[-1] + self.form.samples)
        samples = np.column_stack([column[rows].astype(np.float32) for column in columns])
        found = sliding_window_view(samples, self.form.samples, axis=0)[places - places[0]].transpose(0, 2, 1)
        return np.ascontiguousarray(found)

    def each_action(self) -> Iterator[Floats32]:
        """Every component of the actions by itself, (frames,): a long episode is never whole in memory."""
        return (one[:, -1] for one in self._each(self.asked))

    def each_state(self) -> Iterator[Floats32]:
        """Every component of the states by itself, (frames,)."""
        return (one[:, -1] for one in self._each(self.seen))

    def each_window(self) -> Iterator[Floats32]:
        """Every component of the windows by itself, (frames, samples)."""
        return self._each(self.seen)

    def _each(self, columns: Sequence[Column]) -> Iterator[Floats32]:
        for column in columns:
            samples = column[self.rows].astype(np.float32)
            yield sliding_window_view(samples, self.form.samples)[self.places]


def frames_of(recording: Recording, fps: int) -> Episode:
    """The frames of a log, `fps` a second; UserError where it gives none."""
    log = recording.log
    ticks = _ticks(log)
    every = log.origin.every_ticks or int(np.median(np.diff(ticks)))
    samples_s = _TICKS_PER_S / every
    if fps > samples_s:
        raise UserError(
            f"{log.name}: it has {samples_s:g} samples a second, fewer than the {fps} frames asked for; "
            f"give --fps {int(samples_s)} or less."
        )
    begin, end = _longest_stretch(log, ticks, every)
    width = _TICKS_PER_S // (fps * every)
    last = end - begin - width  # the latest frame's sample, counted from the first frame's
    count = ((last + 1) * fps * every - 1) // _TICKS_PER_S + 1 if last >= 0 else 0
    if count < _LEAST_FRAMES:
        raise UserError(
            f"{log.name}: its longest stretch without a missing sample, with the motors following, is "
            f"{(end - begin) * every / _TICKS_PER_S:g} s long, too short for {_LEAST_FRAMES} frames; record with "
            "--enable, or leave this log out."
        )
    places = np.arange(count) * _TICKS_PER_S // (fps * every)
    joints = log.joints_in_use
    columns = [column for column in recording.columns if column.joint in joints]
    _, *seen = (_SHORT.get(one.name, one.name) for one in recording.quantities)  # the leader is the action
    return Episode(
        form=Form(joints, tuple(name for quantity in seen for name in names_of(joints, quantity)), every, width),
        rows=slice(begin, end),
        places=places,
        asked=columns[: len(joints)],
        seen=columns[len(joints) :],
        remarks=_remarks(log, begin, end),
    )


def _ticks(log: Log) -> Floats:
    """The samples' times in whole ticks of 1 ms."""
    off = _TICKS_PER_S * log.time
    ticks = np.round(off)
    off -= ticks
    odd = np.flatnonzero(np.abs(off, out=off) > 0.01)  # ticks, to within a log's six digits
    if odd.size:
        raise UserError(
            f"{log.name}: its sample at {log.time[odd[0]]:g} s is not at a whole millisecond, so frames would not lie "
            "on samples; export a log that greywhale recorded."
        )
    return ticks


def _longest_stretch(log: Log, ticks: Floats, every: int) -> tuple[int, int]:
    """The first row of the longest stretch that follows without a missing sample, and the row after its last."""
    following = log.following
    if not following.any():
        raise UserError(
            f"{log.name}: the motors do not follow in it, so it shows no action; record with --enable, or leave it out."
        )
    joined = following[1:] & following[:-1] & (np.diff(ticks) == every)
    cuts = np.concatenate([[0], np.flatnonzero(~joined) + 1, [len(ticks)]])
    longest = int(np.argmax(np.diff(cuts)))
    return int(cuts[longest]), int(cuts[longest + 1])


def _remarks(log: Log, begin: int, end: int) -> tuple[str, ...]:
    rows = len(log.time)
    remarks = []
    if not log.complete:
        why = f": {log.ended_by}" if log.ended_by else ""
        remarks.append(f"{log.name}: its recording was interrupted{why}.")
    if end - begin < rows:
        first, last = log.time[begin], log.time[end - 1]
        whole = counted(rows - (end - begin), "row")
        lost = f" ({counted(log.dropped, 'sample')} lost by the link)" if log.dropped else ""
        remarks.append(
            f"{log.name}: the episode is {first:g} to {last:g} s, the longest stretch in which the motors follow and "
            f"no sample is missing{lost}; {whole} beside it are left out."
        )
    return tuple(remarks)
