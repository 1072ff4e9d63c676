"""Samples become stretches of a second on an even grid: what everything here is measured and learnt from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from greywhale.adapt.limits import ADAPTATION_LIMITS, SampleLimits
from greywhale.base.types import Floats
from greywhale.board.stream import Received
from greywhale.loop.traces import Traces
from greywhale.protocol import schema
from greywhale.protocol.firmware import ANGLE_LSB, TICK_S

LENGTH_S = 1.0  # the unit in which an adaptation counts
ROWS = round(LENGTH_S / TICK_S)
_VOLT = schema.Sample.LSB["voltage"]


@dataclass(frozen=True)
class Stretch:
    """A second of work: (ROWS, 4) each, a row a millisecond. `joined`: nothing is missing since the one before."""

    begins_s: float
    joined: bool
    leader: Floats = field(repr=False)  # rad
    follower: Floats = field(repr=False)  # rad
    voltage: Floats = field(repr=False)  # V

    @property
    def error(self) -> Floats:
        """The mean of (leader - follower)², (4,) rad²."""
        found: Floats = np.mean((self.leader - self.follower) ** 2, axis=0)
        return found


def traces_of(chain: Sequence[Stretch]) -> Traces:
    """Stretches that follow each other, as one record."""
    return Traces(
        leader=np.concatenate([one.leader for one in chain]),
        follower=np.concatenate([one.follower for one in chain]),
        voltage=np.concatenate([one.voltage for one in chain]),
        begins=0.0,
    )


def chains_of(stretches: Sequence[Stretch]) -> list[list[Stretch]]:
    """Group the stretches: between two groups something is missing."""
    chains: list[list[Stretch]] = []
    for one in stretches:
        if one.joined and chains:
            chains[-1].append(one)
        else:
            chains.append([one])
    return chains


class Collector:
    """Makes stretches of samples; a gap ends the one in the making."""

    def __init__(self, limits: SampleLimits = ADAPTATION_LIMITS.samples) -> None:
        self._most_lost = limits.max_lost_samples
        self._rows: list[tuple[int, ...]] = []
        self._joined = False

    def cut(self) -> None:
        """Forget the stretch in the making: the next one follows something else."""
        self._rows.clear()
        self._joined = False

    def take(self, received: Received) -> Stretch | None:
        """The stretch that this sample completes, if it does."""
        if received.lost > self._most_lost:
            self.cut()
        sample = received.sample
        self._rows.append((received.elapsed, *sample.leader, *sample.follower, *sample.voltage))
        first = self._rows[0][0]
        if received.elapsed - first < ROWS:
            return None
        known = np.array(self._rows, dtype=np.float64)
        grid = first + np.arange(ROWS, dtype=np.float64)
        even = np.column_stack([np.interp(grid, known[:, 0], column) for column in known[:, 1:].T])
        made = Stretch(
            begins_s=first / 1000,
            joined=self._joined,
            leader=even[:, :4] * ANGLE_LSB,
            follower=even[:, 4:8] * ANGLE_LSB,
            voltage=even[:, 8:] * _VOLT,
        )
        self._rows = self._rows[-1:]
        self._joined = True
        return made
