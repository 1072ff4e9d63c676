"""The part of a long log that shows most about the arm.

The log is cut into pieces of five seconds, without a gap and with the motors following. Each piece shows so much of
five things, for every joint: speed, acceleration, voltage, a joint that holds still against a voltage (friction), and
poses away from the usual one (gravity). Pieces are taken one after another, each time the one that adds most to the sum
of the logarithms of all that is shown. So what is rare counts, and no joint and no thing is left out.
"""

from __future__ import annotations

import numpy as np

from greywhale.base.types import Floats
from greywhale.files.log.driven import driven_rows
from greywhale.files.log.limits import SELECTION
from greywhale.files.log.reader import Log


def informative(log: Log, most_s: float = SELECTION.most_used_s) -> Log:
    """The pieces of a log that show most, `most_s` in all, with gaps between them; a log that is shorter as it is."""
    if len(log.time) < 2 or log.time[-1] - log.time[0] <= most_s:
        return log
    pieces = _pieces(log)
    count = round(most_s / SELECTION.piece_s)
    if len(pieces) <= count:
        return log
    usual = log.held("follower")[:: max(1, len(log.time) // 10_000)].mean(axis=0)
    chosen = _choose(np.array([_shown(log, piece, usual) for piece in pieces]), count)
    rows = np.concatenate([np.arange(pieces[one].start, pieces[one].stop) for one in sorted(chosen)])
    return log.part(rows)


def _pieces(log: Log) -> list[slice]:
    """Pieces of equal length without a gap, in which the motors followed (or, where they never did, with a voltage)."""
    wanted = driven_rows(log)
    steps = np.diff(log.time)
    period = float(np.median(steps))
    length = max(2, round(SELECTION.piece_s / period))
    joined = (steps <= SELECTION.gap_periods * period) & wanted[1:] & wanted[:-1]
    edges = np.flatnonzero(np.diff(np.concatenate(([False], joined, [False])).astype(np.int8)))
    return [
        slice(begin, begin + length)
        for start, stop in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
        for begin in range(start, stop + 2 - length, length)
    ]


def _shown(log: Log, piece: slice, usual: Floats) -> Floats:
    """The amount that a piece shows of five things of every joint, (20,)."""
    time = log.time[piece]
    period = float(time[-1] - time[0]) / (len(time) - 1)
    size = max(1, round(SELECTION.step_s / period))
    angle, volts = (_averaged(log.held(name)[piece], size) for name in ("follower", "voltage"))
    speed = np.diff(angle, axis=0) / (size * period)
    bend = np.diff(speed, axis=0) / (size * period)
    held = (np.abs(speed) < SELECTION.still_rad_s) & (np.abs(volts[1:]) > SELECTION.pushed_v)
    things = (speed**2, bend**2, volts**2, held, (angle - usual) ** 2)
    return np.concatenate([thing.mean(axis=0) if len(thing) else np.zeros(angle.shape[1]) for thing in things])


def _averaged(values: Floats, size: int) -> Floats:
    whole = len(values) // size * size
    means: Floats = values[:whole].reshape(-1, size, values.shape[1]).mean(axis=1)
    return means


def _choose(shown: Floats, count: int) -> list[int]:
    """The places of `count` pieces, (pieces, things) each, by what the next one adds."""
    average = shown.mean(axis=0)
    shown = shown[:, average > 0.0] / average[average > 0.0]
    total = np.zeros(shown.shape[1])
    chosen: list[int] = []
    left = np.ones(len(shown), dtype=bool)
    for _ in range(count):
        gains = np.log1p(total + shown).sum(axis=1)
        best = int(np.argmax(np.where(left, gains, -np.inf)))
        left[best] = False
        total += shown[best]
        chosen.append(best)
    return chosen
