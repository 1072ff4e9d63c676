"""Reads a log back; a malformed line, a non-finite number or time running backwards is refused by file, line and
column.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greywhale.base.errors import UserError, cut
from greywhale.base.formats import csv_file
from greywhale.files.log.check import KEY as CHECK
from greywhale.files.log.check import Check, add_rows, facts_of
from greywhale.files.log.condition import Condition, judge_condition
from greywhale.files.log.episodes import task_in
from greywhale.files.log.held import Numbers, Quantity, Room, State, held, part_of
from greywhale.files.log.layout import (
    COLUMNS,
    COMPLETE,
    ENDINGS,
    INTERRUPTED,
    MOST,
    QUANTITIES,
    STATES,
    TITLE,
    UNFINISHED,
    Origin,
)
from greywhale.files.log.limits import MOTORS
from greywhale.files.log.parameters import table_in
from greywhale.files.log.units import doubt_angles, perhaps_degrees, refuse_other_spacing
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.joints import ALL, Joints, parse
from greywhale.protocol.table import ParameterTable

FOLLOWING = STATES.index("following")
# Where each quantity stands in a row of numbers, behind the time.
_PLACES = {name: slice(1 + place * JOINTS, 1 + (place + 1) * JOINTS) for place, name in enumerate(MOST)}
# What a row holds; of other letters numpy takes some for blanks.
_PLAIN = bytes(range(0x20, 0x7F)) + b"\n"
# A row as numpy reads it; a word that is longer than any state is cut, and still is none.
_ROW = np.dtype([("numbers", np.float64, (len(COLUMNS) - 1,)), ("state", f"S{max(map(len, STATES)) + 1}")])


@dataclass(frozen=True)
class Log:
    """One recording: s, rad and V, one row a sample and one column a joint; `state` holds a word for every row.

    Of a log that was read a quantity is made when it is asked for. For a long one ask `held` for some rows or a joint.
    """

    name: str
    origin: Origin
    time: NDArray[np.float64]
    leader: Quantity = Quantity()  # noqa: RUF009 (of a descriptor, no default)
    follower: Quantity = Quantity()  # noqa: RUF009
    voltage: Quantity = Quantity()  # noqa: RUF009
    state: State = State()  # noqa: RUF009
    dropped: int = 0
    complete: bool = True
    ended_by: str = ""
    condition: Condition = field(default_factory=Condition)  # of the whole file, whatever was selected from it

    @property
    def joints_in_use(self) -> Joints:
        """The joints that the board used; every column of the others is 0."""
        return self.origin.joints

    @property
    def remarks(self) -> tuple[str, ...]:
        """Remarks for whoever uses the log, a sentence each."""
        return tuple(f"{self.name}: {remark}" for remark in self.condition.remarks)

    @property
    def facts(self) -> dict[str, str]:
        """The facts of the header, and how it ended; `check` is the check's outcome."""
        ended = {
            "dropped_samples": str(self.dropped),
            "recording": COMPLETE if self.complete else INTERRUPTED,
            "ended_by": self.ended_by,
            CHECK: self.condition.check.value,
        }
        return self.origin.facts | ended

    def without_samples(self) -> Log:
        """The log without its samples, which take most of the memory."""
        return self.part(np.empty(0, dtype=np.intp))

    def held(self, quantity: str) -> Numbers:
        """The quantity's numbers (rows, joints), of which only those are made that are indexed."""
        return held(self, quantity)

    @property
    def places(self) -> NDArray[np.int8]:
        """The state of each row as its place in STATES."""
        places: NDArray[np.int8] = vars(self)["state"]
        return places

    @property
    def following(self) -> NDArray[np.bool_]:
        """True in the rows (rows,) in state following."""
        following: NDArray[np.bool_] = self.places == FOLLOWING
        return following

    def part(self, rows: slice | NDArray[np.intp] | NDArray[np.bool_]) -> Log:
        """The log of these rows alone."""
        quantities: dict[str, Any] = {name: part_of(self.held(name), rows) for name in QUANTITIES}
        return replace(self, time=self.time[rows], state=self.places[rows], **quantities)


def read_log(path: str | Path) -> Log:
    """Read a log written by `greywhale record`, or by another tool with the same columns and any comments."""
    with csv_file.CsvFile(path, COLUMNS) as file:
        _check_version(file)
        facts = facts_of(file.comments)
        ending = facts.get("recording", COMPLETE)
        if ending not in ENDINGS:
            raise UserError(
                f"{path}: recording is {cut(repr(ending))} in the header; it must be one of {', '.join(ENDINGS)}."
            )
        origin = origin_in(facts, str(path))
        dropped = dropped_in(facts, str(path))
        columns, crc = _Columns(_count_lines(path)), 0
        for block in file.blocks(torn=ending == UNFINISHED):
            columns.take(file, block)
            crc = add_rows(crc, block.data)
        file.require_rows(columns.rows, 2)
    _refuse_other_period(str(path), origin, columns)
    refuse_other_times(str(path), facts, columns.time[: columns.rows])
    condition = judge_condition(str(path), facts, crc, columns.time[: columns.rows])
    if origin.table is None:
        odd = doubt_angles(columns.taken("leader"), columns.taken("follower"))
        condition = replace(condition, remarks=condition.remarks + odd)
    return Log(
        name=str(path),
        origin=origin,
        time=columns.time[: columns.rows],
        leader=columns.taken("leader"),
        follower=columns.taken("follower"),
        voltage=columns.taken("voltage"),
        state=columns.state[: columns.rows],
        dropped=dropped,
        complete=ending == COMPLETE,
        ended_by=facts.get("ended_by", ""),
        condition=condition,
    )


def read_evidence(path: str | Path) -> Log:
    """Read a log that this program recorded, and on which its result will rest: one that is no longer as it was
    recorded is refused.
    """
    log = read_log(path)
    refuse_altered(log, Check.SHORTENED, Check.CHANGED)
    return log


def refuse_altered(log: Log, *refused: Check) -> None:
    """Refuse a log on which a result would rest, if its check says one of these."""
    if log.condition.check in refused:
        raise UserError(
            f"{log.remarks[0].removesuffix('.')}; take the log as it was recorded, or, if it is meant to be so, delete "
            "the line `# check` in its header: it is then a log without a check."
        )


class _Columns:
    """Room for so many rows, filled a block after another."""

    def __init__(self, room: int) -> None:
        self.rows = 0
        self.time = np.empty(room)
        self._quantities = {name: Room(room, JOINTS) for name in _PLACES}
        self.state = np.empty(room, dtype=np.int8)
        self.changes = 0  # rows with another voltage than the row before, while the motors follow
        self._last = np.full((1, JOINTS), np.nan)

    def take(self, file: csv_file.CsvFile, block: csv_file.Block) -> None:
        """Add the rows of a block; what is wrong in them is a UserError that names the cell."""
        before_s = float(self.time[self.rows - 1]) if self.rows else -np.inf
        parsed = parse_rows(block.data)
        if parsed is None or not _is_good(parsed[0], before_s):
            parsed = _cell_by_cell(file.table(block), before_s)
        numbers, states = parsed
        here = slice(self.rows, self.rows + len(numbers))
        self.time[here] = numbers[:, 0]
        for name, places in _PLACES.items():
            self._quantities[name].put(here, numbers[:, places])
        self.state[here] = states
        before_each = np.vstack([self._last, numbers[:, _PLACES["voltage"]]])
        self.changes += int(((np.diff(before_each, axis=0) != 0.0).any(axis=1) & (states == FOLLOWING)).sum())
        self._last = before_each[-1:]
        self.rows = here.stop

    def taken(self, quantity: str) -> Numbers:
        return self._quantities[quantity].taken(self.rows)


def parse_rows(data: bytes) -> tuple[NDArray[np.float64], NDArray[np.int8]] | None:
    """Numbers (rows, 13) and states (rows,) as places in STATES, of whole lines; None where numpy cannot read one."""
    if data.isspace() or data.translate(None, _PLAIN):
        return None
    try:
        rows = np.loadtxt(io.BytesIO(data), _ROW, delimiter=",", comments=None, ndmin=1)
    except ValueError:
        return None
    states = np.full(len(rows), -1, dtype=np.int8)
    for place, word in enumerate(STATES):
        states[rows["state"] == word.encode()] = place
    return None if (states < 0).any() else (rows["numbers"], states)


def refuse_other_times(name: str, facts: Mapping[str, str], time_s: NDArray[np.float64]) -> None:
    """Refuse rows that are further apart than the header's facts say, or closer."""
    refuse_other_spacing(name, _every_ticks(facts, name), dropped_in(facts, name), time_s)


def _refuse_other_period(name: str, origin: Origin, columns: _Columns) -> None:
    """Refuse a control period that the rows contradict: between its ends no voltage changes."""
    if origin.period_ms is None or columns.changes < MOTORS.enough_changes:
        return
    length_ms = 1e3 * float(columns.time[columns.rows - 1] - columns.time[0])
    if columns.changes > MOTORS.most_changes_per_period * length_ms / origin.period_ms:
        raise UserError(
            f"{name}: period_ms is {origin.period_ms} in the header, but by the time column voltages change every "
            f"{length_ms / columns.changes:.3g} ms: it is the header of another log, or was edited."
        )


def _is_good(numbers: NDArray[np.float64], before_s: float) -> bool:
    """True if time goes on, and all is within what a board can say."""
    return csv_file.is_time_axis(numbers[:, 0], before_s) and all(
        bool((np.abs(numbers[:, _PLACES[quantity]]) <= most).all()) for quantity, (most, _) in MOST.items()
    )


def _cell_by_cell(table: csv_file.CsvTable, before_s: float) -> tuple[NDArray[np.float64], NDArray[np.int8]]:
    """Parse rows in any form of CSV like `parse_rows`, each cell checked."""
    time = table.increasing("time_s", before_s)
    for row, cell in enumerate(table.columns["state"]):
        if cell not in STATES:
            raise table.error(row, "state", f"{cut(repr(cell))} is not one of {', '.join(STATES)}")
    quantities = [_joints(table, quantity) for quantity in _PLACES]
    states = np.array([STATES.index(cell) for cell in table.columns["state"]], dtype=np.int8)
    return np.column_stack([time, *quantities]), states


def _count_lines(path: str | Path) -> int:
    """An upper bound on the number of lines of a file."""
    count = 1
    with open(path, "rb") as file:
        while data := file.read(csv_file.BLOCK_BYTES):
            count += data.count(b"\n")
    return count


def _check_version(file: csv_file.CsvFile) -> None:
    for comment in file.comments:
        if comment.startswith(TITLE.rstrip("0123456789")) and comment != TITLE:
            raise UserError(
                f'{file.name} is a "{cut(comment)}", but this greywhale reads "{TITLE}"; '
                "read it with the version that wrote it."
            )


def _joints(table: csv_file.CsvTable, quantity: str) -> NDArray[np.float64]:
    """The quantity of every joint, within what a board can say."""
    most, unit = MOST[quantity]
    columns = []
    for joint in range(JOINTS):
        column = f"{quantity}_{joint}"
        values = table.numbers(column)
        beyond = np.flatnonzero(np.abs(values) > most)
        if beyond.size:
            row = int(beyond[0])
            perhaps = perhaps_degrees(float(np.abs(values).max())) if unit == "rad" else "; these seem to be in mV"
            problem = f"{values[row]:g} {unit} is beyond {most:g} {unit}; logs are in {unit}{perhaps}"
            raise table.error(row, column, problem)
        columns.append(values)
    return np.column_stack(columns)


def origin_in(facts: Mapping[str, str], name: str) -> Origin:
    """The origin that the facts of the header of the log `name` state."""
    board, crc = facts.get("board"), _whole(facts, "parameter_crc", name, 0, 0xFFFF)
    table = table_in(facts, name, crc, board)
    return Origin(
        firmware=facts.get("firmware"),
        board=board,
        param_crc=crc,
        period_ms=_whole(facts, "period_ms", name, 1, 50),
        every_ticks=_every_ticks(facts, name),
        table=table,
        joints=_joints_in_use(facts, name, table),
        task=task_in(facts),
    )


def _joints_in_use(facts: Mapping[str, str], name: str, table: ParameterTable | None) -> Joints:
    """The joints that the header states, or else its parameters; a log that states neither is of a whole arm."""
    if "joints_in_use" in facts:
        return parse(facts["joints_in_use"], f"{name}: joints_in_use")
    return ALL if table is None else table.joints_in_use


def _every_ticks(facts: Mapping[str, str], name: str) -> int | None:
    return _whole(facts, "every_ticks", name, 1, 0xFFFF)


def dropped_in(facts: Mapping[str, str], name: str) -> int:
    """The number of samples that the link lost, as these facts state it."""
    return _whole(facts, "dropped_samples", name, 0, (1 << 63) - 1) or 0


def _whole(facts: Mapping[str, str], key: str, name: str, least: int, most: int) -> int | None:
    text = facts.get(key)
    if text is None:
        return None
    try:
        value = int(text, 0) if csv_file.is_plain(text) else least - 1
    except ValueError:
        value = least - 1
    if not least <= value <= most:
        raise UserError(
            f"{name}: {key} is {cut(repr(text))} in the header; it must be a whole number from {least} to {most}."
        )
    return value
