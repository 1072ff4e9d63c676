"""A log on its way into another format: its own columns, further ones beside them, and its header's facts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from greywhale.base.types import Floats
from greywhale.files.log.held import Numbers
from greywhale.files.log.layout import MOST
from greywhale.files.log.reader import Log

# Rows that are converted at once: an hour at 1 kHz must not stand in memory twice.
CHUNK_ROWS = 1 << 16


@dataclass(frozen=True)
class JointColumns:
    """A quantity of every joint, (rows, joints) in `unit`: such as follower in rad."""

    name: str
    unit: str
    values: Numbers


@dataclass(frozen=True)
class Column:
    """A joint's numbers of one quantity under a log's name of them; index it by rows."""

    name: str
    unit: str
    values: Numbers
    joint: int

    def __getitem__(self, rows: Any) -> Floats:
        numbers: Floats = self.values[rows, self.joint]
        return numbers


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
        own = (JointColumns(name, unit, self.log.held(name)) for name, (_, unit) in MOST.items())
        return (*own, *self.extra)

    @property
    def columns(self) -> tuple[Column, ...]:
        """A column for each joint of each quantity."""
        return tuple(
            Column(f"{one.name}_{joint}", one.unit, one.values, joint)
            for one in self.quantities
            for joint in range(one.values.shape[1])
        )

    @property
    def units(self) -> dict[str, str]:
        return {"time_s": "s"} | {one.name: one.unit for one in self.quantities}

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
