"""Reads a log back; a malformed line, a non-finite number or time running backwards is refused by file, line and
column.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greywhale.config import csv_file
from greywhale.errors import UserError
from greywhale.log.layout import COLUMNS, COMPLETE, ENDINGS, JOINTS, STATES, Origin


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


def read_log(path: str | Path) -> Log:
    """Read a log written by `greywhale record`, or by another tool with the same columns and any comments."""
    table = csv_file.read(path, COLUMNS, minimum_rows=2)
    facts = _facts(table.comments)
    time = table.increasing("time_s")
    for row, cell in enumerate(table.columns["state"]):
        if cell not in STATES:
            raise table.error(row, "state", f"{cell!r} is not one of {', '.join(STATES)}")
    ending = facts.get("recording", COMPLETE)
    if ending not in ENDINGS:
        raise UserError(f"{path}: recording is {ending!r} in the header; it must be one of {', '.join(ENDINGS)}.")
    return Log(
        name=str(path),
        origin=_origin(facts, str(path)),
        time=time,
        leader=_joints(table, "leader"),
        follower=_joints(table, "follower"),
        voltage=_joints(table, "voltage"),
        state=np.array(table.columns["state"]),
        dropped=_whole(facts, "dropped_samples", str(path)) or 0,
        complete=ending == COMPLETE,
    )


def _joints(table: csv_file.CsvTable, quantity: str) -> NDArray[np.float64]:
    return np.column_stack([table.numbers(f"{quantity}_{joint}") for joint in range(JOINTS)])


def _facts(comments: tuple[str, ...]) -> dict[str, str]:
    pairs = (comment.partition(":") for comment in comments)
    return {key.strip(): value.strip() for key, colon, value in pairs if colon}


def _origin(facts: dict[str, str], name: str) -> Origin:
    return Origin(
        firmware=facts.get("firmware"),
        board=facts.get("board"),
        param_crc=_whole(facts, "parameter_crc", name),
        period_ms=_whole(facts, "period_ms", name),
        every_ticks=_whole(facts, "every_ticks", name),
    )


def _whole(facts: dict[str, str], key: str, name: str) -> int | None:
    text = facts.get(key)
    if text is None:
        return None
    try:
        value = int(text, 0)
    except ValueError:
        value = -1
    if value < 0:
        raise UserError(f"{name}: {key} is {text!r} in the header; it must be a whole number from 0.")
    return value
