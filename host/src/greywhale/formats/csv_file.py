"""Reads a CSV file with a fixed set of columns; a bad cell is named by file, line and column.

Lines that start with `#` before the column names are comments; logs keep their facts there.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greywhale.errors import UserError, cut, os_reason
from greywhale.formats.whole import refuse_devices


@dataclass(frozen=True)
class CsvTable:
    """Columns by name as text, the line each row stands on, and the comment lines without their `#`."""

    name: str
    comments: tuple[str, ...]
    lines: tuple[int, ...]
    columns: dict[str, tuple[str, ...]]

    def numbers(self, column: str) -> NDArray[np.float64]:
        """One column as finite numbers."""
        cells = self.columns[column]
        values = np.empty(len(cells))
        for row, cell in enumerate(cells):
            try:
                values[row] = float(cell)
            except ValueError:
                raise self.error(row, column, f"{cut(repr(cell))} is not a number") from None
            if not math.isfinite(values[row]):
                raise self.error(row, column, f"{cut(cell)} is not a finite number")
        return values

    def increasing(self, column: str) -> NDArray[np.float64]:
        """One column as strictly increasing numbers: a time axis."""
        values = self.numbers(column)
        steps = np.flatnonzero(np.diff(values) <= 0.0)
        if steps.size:
            row = int(steps[0]) + 1
            before = self.columns[column][row - 1]
            raise self.error(
                row, column, f"time must increase, but {cut(self.columns[column][row])} follows {cut(before)}"
            )
        return values

    def error(self, row: int, column: str, problem: str) -> UserError:
        return UserError(f"{self.name}, line {self.lines[row]}, column {column}: {problem}.")


def read(path: str | Path, columns: Sequence[str], minimum_rows: int = 1) -> CsvTable:
    """Read `path`, whose column names must be exactly `columns`, in that order."""
    try:
        refuse_devices(path)
        with open(path, encoding="utf-8-sig", newline="") as file:
            return _table(_whole_lines(file.read(), str(path)), columns, str(path), minimum_rows)
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {os_reason(error)}.") from None
    except UnicodeDecodeError as error:
        raise UserError(f"{path}: byte {error.start} is not UTF-8; a CSV file must be plain text.") from None


def _whole_lines(text: str, name: str) -> list[str]:
    """The lines of a file that ends with the end of a line. A number that was cut off is another number."""
    lines = text.splitlines()
    if text and not text.endswith(("\n", "\r")):
        raise UserError(
            f"{name}, line {len(lines)}: the file ends in the middle of this line; copy it again, or end the line "
            "(Enter) if it is whole."
        )
    return lines


def _table(text: list[str], wanted: Sequence[str], name: str, minimum_rows: int) -> CsvTable:
    head = 0
    while head < len(text) and text[head].startswith("#"):
        head += 1
    if head == len(text):
        raise UserError(f"{name}: the file has no columns; it must start with {','.join(wanted)}.")
    found = [cell.strip() for cell in _cells(text[head], name, head + 1)]
    if found != list(wanted):
        raise UserError(f"{name}, line {head + 1}: {_column_problem(found, wanted)}.")
    lines: list[int] = []
    rows: list[list[str]] = []
    for number, line in enumerate(text[head + 1 :], head + 2):
        if not line.strip():
            continue
        cells = _cells(line, name, number)
        if len(cells) != len(wanted):
            raise UserError(f"{name}, line {number}: {len(cells)} values where {len(wanted)} columns are named.")
        lines.append(number)
        rows.append(cells)
    if len(rows) < minimum_rows:
        raise UserError(f"{name}: {len(rows)} rows of data, but at least {minimum_rows} are needed.")
    transposed = list(zip(*rows, strict=True)) if rows else [() for _ in wanted]
    comments = tuple(line[1:].strip() for line in text[:head])
    return CsvTable(name, comments, tuple(lines), dict(zip(wanted, transposed, strict=True)))


def _cells(line: str, name: str, number: int) -> list[str]:
    try:
        return next(csv.reader([line], strict=True))
    except csv.Error as error:
        raise UserError(f"{name}, line {number}: not valid CSV: {error}.") from None


def _column_problem(found: Sequence[str], wanted: Sequence[str]) -> str:
    missing = [column for column in wanted if column not in found]
    unknown = [column for column in found if column not in wanted]
    if missing:
        problem = f"column {missing[0]} is missing"
    elif unknown:
        problem = f"column {cut(repr(unknown[0]))} is unknown"
    else:
        problem = "the columns are not in order"
    return f"{problem}; the columns must be {','.join(wanted)}"
