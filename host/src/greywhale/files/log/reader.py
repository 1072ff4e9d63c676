"""Reads a log back; a malformed line, a non-finite number or time running backwards is refused by file, line and
column.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greywhale.errors import UserError, cut
from greywhale.files.log.layout import COLUMNS, COMPLETE, ENDINGS, STATES, TITLE, Origin
from greywhale.firmware import JOINTS
from greywhale.formats import csv_file

_MOST_WHOLE = (1 << 63) - 1
# No board sends larger values: 16 bits of 1/4096 rad and of mV. Such values are another tool's degrees or millivolts.
_MOST = {"leader": (8.0, "rad"), "follower": (8.0, "rad"), "voltage": (33.0, "V")}


@dataclass(frozen=True)
class Log:
    """One recording: s, rad and V, one row a sample and one column a joint; `state` holds a word for every row."""

    name: str
    origin: Origin
    time: NDArray[np.float64]
    leader: NDArray[np.float64]
    follower: NDArray[np.float64]
    voltage: NDArray[np.float64]
    state: NDArray[np.str_]
    dropped: int
    complete: bool
    ended_by: str = ""


def read_log(path: str | Path) -> Log:
    """Read a log written by `greywhale record`, or by another tool with the same columns and any comments."""
    table = csv_file.read(path, COLUMNS, minimum_rows=2)
    _check_version(table)
    facts = _facts(table.comments)
    time = table.increasing("time_s")
    for row, cell in enumerate(table.columns["state"]):
        if cell not in STATES:
            raise table.error(row, "state", f"{cut(repr(cell))} is not one of {', '.join(STATES)}")
    ending = facts.get("recording", COMPLETE)
    if ending not in ENDINGS:
        raise UserError(
            f"{path}: recording is {cut(repr(ending))} in the header; it must be one of {', '.join(ENDINGS)}."
        )
    return Log(
        name=str(path),
        origin=_origin(facts, str(path)),
        time=time,
        leader=_joints(table, "leader"),
        follower=_joints(table, "follower"),
        voltage=_joints(table, "voltage"),
        state=np.array(table.columns["state"]),
        dropped=_whole(facts, "dropped_samples", str(path), 0, _MOST_WHOLE) or 0,
        complete=ending == COMPLETE,
        ended_by=facts.get("ended_by", ""),
    )


def _check_version(table: csv_file.CsvTable) -> None:
    for comment in table.comments:
        if comment.startswith(TITLE.rstrip("0123456789")) and comment != TITLE:
            raise UserError(
                f'{table.name} is a "{cut(comment)}", but this greywhale reads "{TITLE}"; '
                "read it with the version that wrote it."
            )


def _joints(table: csv_file.CsvTable, quantity: str) -> NDArray[np.float64]:
    """The quantity of every joint, within what a board can say."""
    most, unit = _MOST[quantity]
    columns = []
    for joint in range(JOINTS):
        column = f"{quantity}_{joint}"
        values = table.numbers(column)
        beyond = np.flatnonzero(np.abs(values) > most)
        if beyond.size:
            row = int(beyond[0])
            raise table.error(row, column, f"{values[row]:g} {unit} is beyond {most:g} {unit}; logs are in {unit}")
        columns.append(values)
    return np.column_stack(columns)


def _facts(comments: tuple[str, ...]) -> dict[str, str]:
    pairs = (comment.partition(":") for comment in comments)
    return {key.strip(): value.strip() for key, colon, value in pairs if colon}


def _origin(facts: dict[str, str], name: str) -> Origin:
    return Origin(
        firmware=facts.get("firmware"),
        board=facts.get("board"),
        param_crc=_whole(facts, "parameter_crc", name, 0, 0xFFFF),
        period_ms=_whole(facts, "period_ms", name, 1, 50),
        every_ticks=_whole(facts, "every_ticks", name, 1, 0xFFFF),
    )


def _whole(facts: dict[str, str], key: str, name: str, least: int, most: int) -> int | None:
    text = facts.get(key)
    if text is None:
        return None
    try:
        value = int(text, 0)
    except ValueError:
        value = least - 1
    if not least <= value <= most:
        raise UserError(
            f"{name}: {key} is {cut(repr(text))} in the header; it must be a whole number from {least} to {most}."
        )
    return value
