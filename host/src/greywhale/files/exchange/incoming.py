"""Writes the columns of another program's file as a log.

Of a file that greywhale exported the log's facts come back too, and the log is the same, byte for byte, where no column
is named anew.
"""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greywhale.base.errors import UserError, cut
from greywhale.base.types import Floats
from greywhale.files.exchange.columns import NUMBERS, STATE, TIME, ColumnMap, Rule, choose
from greywhale.files.exchange.recording import CHUNK_ROWS
from greywhale.files.exchange.sources import Columns, Source, open_source
from greywhale.files.log.check import KEY as CHECK
from greywhale.files.log.check import Check
from greywhale.files.log.layout import COMPLETE, MOST, QUANTITIES, STATES, Origin
from greywhale.files.log.reader import dropped_in, origin_in
from greywhale.files.log.units import doubt_angles, doubt_spacing
from greywhale.files.log.writer import LogWriter
from greywhale.protocol.firmware import JOINTS

# A log without words for its states is one of motors that follow: its rows are measured.
FOLLOWING = STATES.index("following")


@dataclass(frozen=True)
class Imported:
    """The log that was written: its rows, its joints, and remarks as sentences."""

    rows: int
    joints: tuple[int, ...]
    remarks: tuple[str, ...]


def import_log(path: Path, format_: str, out: Path, asked: Mapping[str, Rule], joint: int | None = None) -> Imported:
    """Write the log `out` from the file `path`; `asked` are rules for columns. UserError names what is wrong where."""
    source = open_source(path, format_, joint)
    chosen = choose(str(path), source.names, source.usual, asked)
    # Numbers that were changed on their way are no longer those of the board that the facts are about.
    facts = {} if asked else source.facts
    if facts.get(CHECK) in (Check.CHANGED, Check.SHORTENED):
        raise UserError(
            f"{path}: the log from which it was exported was {facts[CHECK]} by its check; export the log as it was "
            "recorded, or name the columns with --column: the new log then claims nothing of a board."
        )
    origin = origin_in(facts, str(path)) if facts else Origin(joints=chosen.joints)
    numbers, states = _load(str(path), source, chosen)
    _write(out, origin, facts, numbers, states)
    doubts = () if facts else _doubts(numbers)
    return Imported(len(numbers[TIME]), origin.joints, tuple(f"{path}: {doubt}" for doubt in doubts))


def _load(name: str, source: Source, chosen: ColumnMap) -> tuple[Columns, NDArray[np.int8]]:
    """The log's columns of numbers, and its states as places in STATES."""
    rules = dict(chosen.rules)
    word = rules.pop(STATE, None)
    loaded = source.load(sorted({rule.source for rule in rules.values()}), [word.source] if word else [])
    numbers = {target: _apply(name, target, rule, loaded[rule.source]) for target, rule in rules.items()}
    sizes = {len(column) for column in loaded.values()}
    if len(sizes) > 1 or min(sizes) < 2:
        raise UserError(
            f"{name}: its columns have {' and '.join(map(str, sorted(sizes)))} rows; a log needs the same number of "
            "each, and 2 at least."
        )
    _refuse_time(name, rules[TIME].source, numbers[TIME])
    if word is None:
        return numbers, np.full(len(numbers[TIME]), FOLLOWING, dtype=np.int8)
    return numbers, _states(name, word.source, loaded[word.source])


def _apply(name: str, target: str, rule: Rule, column: NDArray[np.generic]) -> Floats:
    """A column as the log's numbers, within what a log holds."""
    try:
        found = np.asarray(column, dtype=np.float64)
    except (ValueError, TypeError):
        raise UserError(f"{name}: column {cut(rule.source)} for {target} holds no numbers; name another one.") from None
    values = found if rule.plain else rule.unit * (rule.sign * found + rule.offset)
    most, unit = MOST.get(target.rpartition("_")[0], (np.inf, ""))
    wrong = np.flatnonzero(~np.isfinite(values) | (np.abs(values) > most))
    if wrong.size:
        row = int(wrong[0])
        limit = f"beyond {most:g} {unit}" if np.isfinite(values[row]) else "no finite number"
        raise UserError(
            f"{name}, row {row + 1}, column {cut(rule.source)}: {target} would be {values[row]:g}, which is {limit}; "
            f"say its unit, sign and offset with --column {target}={cut(rule.source)},UNIT,SIGN,OFFSET."
        )
    return values


def _refuse_time(name: str, column: str, time_s: Floats) -> None:
    steps = np.diff(np.round(time_s * 1e6))
    back = np.flatnonzero(steps < 1.0)
    if back.size:
        row = int(back[0]) + 1
        raise UserError(
            f"{name}, row {row + 1}, column {cut(column)}: time must increase by a microsecond or more, but "
            f"{time_s[row]:g} s follows {time_s[row - 1]:g} s; sort the rows, or say the unit with "
            f"--column {TIME}={cut(column)},UNIT."
        )


def _states(name: str, column: str, words: NDArray[np.generic]) -> NDArray[np.int8]:
    places = np.full(len(words), -1, dtype=np.int8)
    for place, word in enumerate(STATES):
        places[words == word] = place
    unknown = np.flatnonzero(places < 0)
    if unknown.size:
        row = int(unknown[0])
        raise UserError(
            f"{name}, row {row + 1}, column {cut(column)}: {cut(str(words[row]))} is no state; a log has "
            f"{', '.join(STATES)}."
        )
    return places


class _EndedEarly(UserError):
    """Ends a log that was not recorded to its end, as the log did that it comes from."""


def _write(out: Path, origin: Origin, facts: Mapping[str, str], numbers: Columns, states: NDArray[np.int8]) -> None:
    columns = [numbers.get(column) for column in NUMBERS]
    nothing = np.zeros(CHUNK_ROWS)
    parts = [slice(1 + place * JOINTS, 1 + (place + 1) * JOINTS) for place in range(len(QUANTITIES))]
    with contextlib.suppress(_EndedEarly), LogWriter(out, origin) as log:
        for begin in range(0, len(states), CHUNK_ROWS):
            rows = slice(begin, begin + CHUNK_ROWS)
            some = [(nothing if one is None else one[rows])[: len(states[rows])] for one in columns]
            for values, state in zip(np.column_stack(some).tolist(), states[rows].tolist(), strict=True):
                leader, follower, voltage = (values[part] for part in parts)
                log.append(values[0], leader, follower, voltage, STATES[state])
        log.drop(dropped_in(facts, str(out)))
        if facts.get("recording", COMPLETE) != COMPLETE:
            raise _EndedEarly(facts.get("ended_by", ""))


def _doubts(numbers: Columns) -> tuple[str, ...]:
    """Doubts about the units, as a reader of the log would have them."""
    angles = [column for target, column in numbers.items() if target.startswith(("leader", "follower"))]
    return doubt_spacing(numbers[TIME]) + doubt_angles(*angles)
