"""Reads a CSV file with a fixed set of columns; a bad cell is named by file, line and column.

Lines that start with `#` are comments; logs keep their facts in those before the column names. Empty lines say nothing.
What spreadsheets make of such a file is read too (`csv_dialect`). A file is read in blocks of whole lines, so that one
of an hour needs no more memory than what is made of it.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from greywhale.base.errors import UserError, counted, cut, os_reason
from greywhale.base.formats import csv_dialect
from greywhale.base.formats.whole import refuse_devices

# Bytes that are read at once; no line is longer.
BLOCK_BYTES = 1 << 22
_BOM = b"\xef\xbb\xbf"
# Times of recordings: three centuries, such as those since 1970, and steps of a microsecond, which decimals may round.
_MOST_S, _LEAST_STEP_S = 1e10, 5e-7


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
                values[row] = number(cell)
            except ValueError:
                remedy = "; numbers have a decimal point, and no other comma" if "," in cell else ""
                raise self.error(row, column, f"{cut(repr(cell))} is not a number{remedy}") from None
            if not math.isfinite(values[row]):
                raise self.error(row, column, f"{cut(cell)} is not a finite number")
        return values

    def increasing(self, column: str, before: float = -math.inf) -> NDArray[np.float64]:
        """One column as strictly increasing numbers, all above `before`: a time axis, in s."""
        values = self.numbers(column)
        if is_time_axis(values, before):
            return values
        beyond = np.flatnonzero(np.abs(values) > _MOST_S)
        if beyond.size:
            row = int(beyond[0])
            raise self.error(row, column, f"{cut(self.columns[column][row])} s is beyond {_MOST_S:g} s; times are in s")
        steps = np.diff(values, prepend=before)
        row = int(np.flatnonzero(steps < _LEAST_STEP_S)[0])
        last = self.columns[column][row - 1] if row else f"{before:.6f}"
        least = " by a microsecond or more" if steps[row] > 0.0 else ""
        problem = f"time must increase{least}, but {cut(self.columns[column][row])} follows {cut(last)}"
        raise self.error(row, column, problem)

    def error(self, row: int, column: str, problem: str) -> UserError:
        return UserError(f"{self.name}, line {self.lines[row]}, column {column}: {problem}.")


@dataclass(frozen=True)
class Block:
    """Whole lines of a file, the first of which has the number `line`; `offset` counts the bytes before them."""

    data: bytes
    line: int
    offset: int


class CsvFile:
    """A file opened for reading, a context: `comments` and the checked `columns` are read, `blocks` are not.

    Its columns must be one of the sets in `wanted`, in that order.
    """

    def __init__(self, path: str | Path, *wanted: Sequence[str]) -> None:
        self.name = str(path)
        self.comments: tuple[str, ...] = ()
        self.columns: Sequence[str] = wanted[0]
        self._wanted = wanted
        self._path = path
        self._separator = ","
        self._marks = b""  # decimal ones, in a file whose separator is no comma

    def __enter__(self) -> CsvFile:
        try:
            refuse_devices(self._path)
            self._file: IO[bytes] = open(self._path, "rb")
        except OSError as error:
            raise self._cannot_be_read(error) from None
        try:
            self._read_head()
        except BaseException:
            self._file.close()
            raise
        return self

    def __exit__(self, *error: object) -> None:
        self._file.close()

    def blocks(self, torn: bool = False) -> Iterator[Block]:
        """The lines below the column names, without comments, with commas between the cells and decimal points.

        A last line without an end is dropped if it may be `torn`, else refused.
        """
        line, offset, rest = self._line, self._offset, b""
        try:
            while data := self._file.read(BLOCK_BYTES):
                data = rest + data
                end = data.rfind(b"\n") + 1
                rest = data[end:]
                self._refuse_long(rest, line + data.count(b"\n", 0, end))
                if end:
                    for lines, before, part in csv_dialect.without_comments(data[:end]):
                        yield Block(self._with_commas(part), line + lines, offset + before)
                    line, offset = line + data.count(b"\n", 0, end), offset + end
        except OSError as error:
            raise self._cannot_be_read(error) from None
        if rest and not torn and not rest.lstrip(b' \t"').startswith(b"#"):
            raise UserError(
                f"{self.name}, line {line}: the file ends in the middle of this line; copy it again, or end the line "
                "(Enter) if it is whole."
            )

    def table(self, block: Block) -> CsvTable:
        lines: list[int] = []
        rows: list[list[str]] = []
        for number, line in enumerate(_text(block, self.name).split("\n")[:-1], block.line):
            cells = _cells(line.removesuffix("\r"), self.name, number, least=len(self.columns))
            if not any(cells):
                continue
            if len(cells) != len(self.columns):
                raise UserError(f"{self.name}, line {number}: {_row_problem(cells, self.columns)}.")
            if cells == list(self.columns):
                raise UserError(
                    f"{self.name}, line {number}: the column names stand here again, as where two files were joined; "
                    "put what begins here into a file of its own."
                )
            lines.append(number)
            rows.append(cells)
        transposed = list(zip(*rows, strict=True)) if rows else [() for _ in self.columns]
        return CsvTable(self.name, self.comments, tuple(lines), dict(zip(self.columns, transposed, strict=True)))

    def require_rows(self, found: int, least: int) -> None:
        if found < least:
            raise UserError(f"{self.name}: {counted(found, 'row')} of data, but at least {least} are needed.")

    def _read_head(self) -> None:
        comments = []
        self._line, self._offset = 1, 0
        while True:
            try:
                data = self._file.readline(BLOCK_BYTES)
            except OSError as error:
                raise self._cannot_be_read(error) from None
            if not data:
                raise UserError(f"{self.name}: the file has no columns; it must start with {','.join(self.columns)}.")
            self._refuse_long(b"" if data.endswith(b"\n") else data, self._line)
            text = _text(
                Block(data.removeprefix(_BOM) if self._line == 1 else data, self._line, self._offset), self.name
            )
            self._line, self._offset = self._line + 1, self._offset + len(data)
            if "\r" in text.rstrip("\r\n"):
                raise UserError(f"{self.name}: its lines end with CR alone; save it with LF or CR LF at the ends.")
            comment = csv_dialect.comment_in(text)
            if comment is not None:
                comments.append(comment)
            elif text.strip(" \r\n" + "".join(csv_dialect.SEPARATORS)):
                break
        self.comments = tuple(comments)
        self._check_columns(text.rstrip("\r\n"))

    def _check_columns(self, text: str) -> None:
        """Find the separator and the set of columns by the line with their names; refuse all others."""
        self._separator = csv_dialect.separator_of(text, [name for names in self._wanted for name in names])
        found = _cells(text, self.name, self._line - 1, self._separator)
        self.columns = min(self._wanted, key=lambda names: len(set(names) ^ set(found)))
        if found == list(self.columns):
            return
        where = f"{self.name}, line {self._line - 1}"
        if "=" in text or text.startswith("["):
            raise UserError(f"{self.name}: this is TOML, but a log or a motion (CSV) is needed here.")
        if any(_is_heading(comment, self._wanted) for comment in self.comments):
            raise UserError(f"{where}: the column names above stand behind a #; take it away.")
        if text.split() in [list(names) for names in self._wanted]:
            raise UserError(f"{where}: the columns are separated by blanks; save it with commas between them.")
        raise UserError(f"{where}: {_column_problem(found, self.columns)}.")

    def _with_commas(self, lines: bytes) -> bytes:
        """The lines with commas as separators. Where these are others, all decimal marks must be alike."""
        if self._separator == ",":
            return lines
        self._marks += b"".join(mark for mark in (b",", b".") if mark in lines and mark not in self._marks)
        if len(self._marks) > 1:
            raise UserError(
                f"{self.name}: its numbers have commas and points, so nobody knows which is the decimal mark; save it "
                "with decimal points alone."
            )
        return csv_dialect.to_commas(lines, self._separator)

    def _refuse_long(self, line: bytes, number: int) -> None:
        if len(line) >= BLOCK_BYTES:
            raise UserError(f"{self.name}, line {number}: a line of more than {BLOCK_BYTES} bytes; is this a CSV file?")

    def _cannot_be_read(self, error: OSError) -> UserError:
        return UserError(f"{self.name}: cannot be read: {os_reason(error)}.")


def is_time_axis(values: NDArray[np.float64], before: float) -> bool:
    """True if these are times of a recording, in s, that go on after `before`."""
    return bool((np.abs(values) <= _MOST_S).all() and (np.diff(values, prepend=before) >= _LEAST_STEP_S).all())


def is_plain(text: str) -> bool:
    """True if a number is in digits that everyone reads alike: Python takes those of all alphabets, and 1_000."""
    return text.isascii() and "_" not in text


def number(text: str) -> float:
    """The decimal number that a text is; else ValueError."""
    if not is_plain(text):
        raise ValueError(text)
    return float(text)


def _is_heading(text: str, wanted: Sequence[Sequence[str]]) -> bool:
    """True if a line has the names of columns, however they are separated."""
    words = text.replace(",", " ").replace(";", " ").replace('"', " ").split()
    return any(words == list(names) for names in wanted)


def read(path: str | Path, columns: Sequence[str], minimum_rows: int = 1) -> CsvTable:
    """Read all of `path`, whose column names must be exactly `columns`, in that order."""
    with CsvFile(path, columns) as file:
        tables = [file.table(block) for block in file.blocks()]
        lines = tuple(line for table in tables for line in table.lines)
        file.require_rows(len(lines), minimum_rows)
        joined = {name: tuple(cell for table in tables for cell in table.columns[name]) for name in columns}
    return CsvTable(file.name, file.comments, lines, joined)


def _text(block: Block, name: str) -> str:
    try:
        return block.data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise UserError(
            f"{name}: byte {block.offset + error.start} is not UTF-8; save it as CSV in UTF-8, which is plain text."
        ) from None


def _cells(line: str, name: str, number: int, separator: str = ",", least: int = 0) -> list[str]:
    try:
        return csv_dialect.cells_of(line, separator, least)
    except csv.Error as error:
        raise UserError(f"{name}, line {number}: not valid CSV: {error}.") from None


def _row_problem(cells: Sequence[str], columns: Sequence[str]) -> str:
    problem = f"{counted(len(cells), 'value')} where {len(columns)} columns are named"
    if len(cells) > len(columns):
        return f"{problem}; if its decimal marks are commas, save it with decimal points"
    if len(cells) == 1 and cells[0][:1].isalpha():
        return f"{problem}: {cut(repr(cells[0]))}; a comment begins with #"
    return problem


def _column_problem(found: Sequence[str], wanted: Sequence[str]) -> str:
    missing = [column for column in wanted if column not in found]
    unknown = [column for column in found if column not in wanted]
    alike = [cell for cell in unknown if missing and cell.lower() == missing[0].lower()]
    if missing:
        problem = f"column {missing[0]} is missing" + (f", but there is {cut(repr(alike[0]))}" if alike else "")
    elif "" in unknown:
        problem = (
            f"column {found.index('') + 1} has no name, as the numbers of rows that some programs add; leave it out"
        )
    elif unknown:
        problem = f"column {cut(repr(unknown[0]))} is unknown"
    else:
        problem = "the columns are not in order"
    return f"{problem}; the columns must be {','.join(wanted)}"
