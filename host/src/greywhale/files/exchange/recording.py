"""A log on its way into another format: its own columns, further ones beside them, and its header's facts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from greywhale.base.types import Floats
from greywhale.files.log.layout import STATES
from greywhale.files.log.reader import Log

# Rows that are converted at once: an hour at 1 kHz must not stand in memory twice.
CHUNK_ROWS = 1 << 16


@dataclass(frozen=True)
class JointColumns:
    """A quantity of every joint, (rows, joints) in `unit`: such as follower in rad."""

    name: str
    unit: str
    values: Floats


@dataclass(frozen=True)
class Recording:
    """A log, and what was computed from it: `extra` has a row for each of the log's, under names that it does not
    have itself.
    """

    log: Log
    extra: tuple[JointColumns, ...] = ()

    @property
    def quantities(self) -> tuple[JointColumns, ...]:
        """All quantities of the joints, those of the log first."""
        log = self.log
        own = (("leader", "rad", log.leader), ("follower", "rad", log.follower), ("voltage", "V", log.voltage))
        return (*(JointColumns(*one) for one in own), *self.extra)

    @property
    def columns(self) -> tuple[tuple[str, str, Floats], ...]:
        """A column for each joint of each quantity, under the names of a log: name, unit and values (rows,)."""
        return tuple(
            (f"{one.name}_{joint}", one.unit, column)
            for one in self.quantities
            for joint, column in enumerate(one.values.T)
        )

    @property
    def units(self) -> dict[str, str]:
        return {"time_s": "s"} | {one.name: one.unit for one in self.quantities}

    @cached_property
    def states(self) -> NDArray[np.int8]:
        """The state of each row as its place in `STATES`."""
        words = self.log.state
        if words.size and words.strides == (0,):  # one word for all rows
            return np.full(words.size, STATES.index(str(words[0])), dtype=np.int8)
        places = np.zeros(words.size, dtype=np.int8)
        for rows in self.chunks():
            for place, word in enumerate(STATES):
                places[rows][words[rows] == word] = place
        return places

    def chunks(self) -> Iterator[slice]:
        """The rows, in parts that are small in memory."""
        for begin in range(0, len(self.log.time), CHUNK_ROWS):
            yield slice(begin, begin + CHUNK_ROWS)


@dataclass(frozen=True)
class ExportOptions:
    """The options that only some formats take (`Format.options`); None: it was not given."""

    joint: int | None = None
    mass: float | None = None  # kg
    length: float | None = None  # m
    fps: int | None = None  # frames a second
    task: str | None = None  # in words
    model: str | None = None  # file of an identified arm: the torque from outside goes beside the log's quantities
