"""The frames of a LeRobot episode from a log: what the arm was asked and what it did, at whole frames a second.

A frame carries the last sample at or before its time. At 30 frames a second and 1 kHz that is frame i at the tick
floor(1000 i / 30), less than a millisecond before i/30 s; rates that divide 1000 (20, 25, 40, 50) fall on ticks. Beside
it stand all samples since the frame before, as a window. Nothing is filled in: an episode is the longest stretch of a
log in which no sample is missing and the motors follow all the time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from greywhale.base.errors import UserError, counted
from greywhale.files.exchange.recording import Recording
from greywhale.files.log import Log
from greywhale.protocol.joints import NAMES, Joints

Floats32 = NDArray[np.float32]

_TICKS_PER_S = 1000
# Times of a log are whole ticks to within its six digits.
_TICK_ROUNDING = 0.01
_SHORT = {"follower": "pos"}
_FOLLOWING = "following"
_LEAST_FRAMES = 2  # statistics need so many


def names_of(joints: Joints, quantity: str) -> list[str]:
    """The names of a quantity's components: yaw.pos. A position is in rad, a voltage in V."""
    return [f"{NAMES[joint]}.{quantity}" for joint in joints]


@dataclass(frozen=True)
class Episode:
    """One log as frames; `remarks` say what of it is left out, a sentence each."""

    joints: Joints
    components: tuple[str, ...]  # of the state, such as yaw.pos
    every_ticks: int  # between two samples of a window
    action: Floats32  # (frames, joints), rad
    state: Floats32  # (frames, components): the follower's angles in rad, the voltages in V, and what was computed
    window: Floats32  # (frames, samples, components): of each frame the last samples, its own at the end
    remarks: tuple[str, ...]


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
    joints = list(log.joints_in_use)
    _, *seen = recording.quantities  # the leader is the action
    samples = np.hstack([one.values[begin:end, joints].astype(np.float32) for one in seen])
    window = sliding_window_view(samples, width, axis=0)[places].transpose(0, 2, 1)
    return Episode(
        joints=log.joints_in_use,
        components=tuple(name for one in seen for name in names_of(log.joints_in_use, _SHORT.get(one.name, one.name))),
        every_ticks=every,
        action=log.leader[begin + width - 1 + places][:, joints].astype(np.float32),
        state=np.ascontiguousarray(window[:, -1]),
        window=np.ascontiguousarray(window),
        remarks=_remarks(log, begin, end),
    )


def _ticks(log: Log) -> NDArray[np.int64]:
    """The samples' times in ticks of 1 ms."""
    exact = _TICKS_PER_S * log.time
    ticks = np.round(exact).astype(np.int64)
    odd = np.flatnonzero(np.abs(exact - ticks) > _TICK_ROUNDING)
    if odd.size:
        raise UserError(
            f"{log.name}: its sample at {log.time[odd[0]]:g} s is not at a whole millisecond, so frames would not lie "
            "on samples; export a log that greywhale recorded."
        )
    return ticks


def _longest_stretch(log: Log, ticks: NDArray[np.int64], every: int) -> tuple[int, int]:
    """The first row of the longest stretch that follows without a missing sample, and the row after its last."""
    following = log.state == _FOLLOWING
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
