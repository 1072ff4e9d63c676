"""A verb's result for people as data: sentences, tables, motions to draw, and the steps that come next.

A terminal prints it as text, a page shows it as headings, tables and buttons. Both read the same numbers, as texts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar

from greywhale.base.errors import printable

LINE_COLUMNS = 80  # of a terminal; a remark behind a row stays within, where it can
BULLET = "- "
BESIDE = "-> "  # before what stands below a row

# A line of text, and by how many columns the rest hangs where it is broken.
Line = tuple[str, int]


@dataclass(frozen=True)
class Sentences:
    """A line each, under a title if there is one."""

    kind: ClassVar = "sentences"
    lines: Sequence[str]
    title: str = ""
    listed: bool = False  # a bullet before each
    grave: bool = False  # they speak against the result
    near: bool = False  # no empty line before them

    def text(self) -> Iterator[Line]:
        if self.title:
            yield f"{self.title}:", 0
        for line in self.lines:
            yield (f"{BULLET}{line}", len(BULLET)) if self.listed else (line, 0)


@dataclass(frozen=True)
class Column:
    """A column of a table. A terminal breaks the head where it has a new line, and puts the unit in brackets."""

    head: str = ""
    unit: str = ""
    width: int = 0  # in a terminal, behind a blank; 0: as its longest cell, behind two
    left: bool = False  # words stand at the left edge, numbers at the right; a row's name is a word

    def heads(self) -> list[str]:
        unit = f" [{self.unit}]" if self.unit else ""
        return [line.strip() for line in f"{self.head}{unit}".split("\n")]


@dataclass(frozen=True)
class Row:
    """Cells from the first column on. A single cell is the heading of the rows below it."""

    cells: Sequence[str]
    remark: str = ""  # behind the last cell
    below: str = ""  # what to do about it, under the last cell


@dataclass(frozen=True)
class Table:
    kind: ClassVar = "table"
    columns: Sequence[Column]
    rows: Sequence[Row]
    title: str = ""
    near: bool = False

    def text(self) -> Iterator[Line]:
        places = self._places()
        hang = places[-1][0] if self.columns[-1].left else 0
        if self.title:
            yield self.title, 0
        heads = [column.heads() for column in self.columns]
        for number in range(max(map(len, heads)) if any(map(any, heads)) else 0):
            yield self._line([one[number] if number < len(one) else "" for one in heads], places), hang
        for row in self.rows:
            line = self._line(row.cells, places)
            if row.remark:
                gap = max(1, min(3, LINE_COLUMNS - len(line) - len(row.remark)))
                line += " " * gap + row.remark
            yield line, hang
            if row.below:
                yield " " * hang + BESIDE + row.below, hang

    def _places(self) -> list[tuple[int, int]]:
        """The columns of a terminal at which each column begins and ends."""
        found: list[tuple[int, int]] = []
        end = 0
        for number, column in enumerate(self.columns):
            gap = (1 if column.width else 2) if number else 0
            cells = [*column.heads(), *(row.cells[number] for row in self.rows if number < len(row.cells) > 1)]
            begin, end = end + gap, end + gap + (column.width or max(map(len, cells)))
            found.append((begin, end))
        return found

    def _line(self, cells: Sequence[str], places: Sequence[tuple[int, int]]) -> str:
        """Cells at their places; one that is too long moves the next ones, which no blank would part from it."""
        line = ""
        for column, cell, (begin, end) in zip(self.columns, cells, places, strict=False):
            line = line.ljust(begin if column.left else end - len(cell))
            line += f" {cell}" if line.strip() and not line.endswith(" ") else cell
        return line.rstrip()


@dataclass(frozen=True)
class Motions:
    """Logs whose leader and followers a page draws over each other, by their names there. A terminal shows none."""

    kind: ClassVar = "motions"
    logs: Mapping[str, str]  # name to file
    title: str = ""
    near: bool = True

    def text(self) -> Iterator[Line]:
        return iter(())


@dataclass(frozen=True)
class Step:
    """A verb that may come next, with the values of its arguments by their names."""

    verb: str
    words: str  # of a page's button
    given: Mapping[str, object] = field(default_factory=dict)


Part = Sentences | Table | Motions


@dataclass(frozen=True)
class Telling:
    """All that is told of a result, in the order of reading, and the steps that come next, the natural one first."""

    parts: Sequence[Part]
    steps: Sequence[Step] = ()

    def lines(self) -> list[Line]:
        found: list[Line] = []
        for part in self.parts:
            lines = list(part.text())
            found += [("", 0)] if found and lines and not part.near else []
            found += lines
        return found

    def text(self) -> str:
        return "\n".join(line for line, _ in self.lines())

    def as_dict(self) -> dict[str, Any]:
        """For a page: it obeys no control characters, and knows the parts by their kinds."""
        facts: dict[str, Any] = _plain(self)
        return facts


def told(*lines: str, steps: Sequence[Step] = ()) -> Telling:
    """A result in some sentences."""
    return Telling((Sentences(lines),), steps)


def _plain(value: Any) -> Any:
    """Dataclasses and their values as JSON has them."""
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, Mapping):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, Sentences | Table | Motions | Telling | Column | Row | Step):
        own = {one.name: _plain(getattr(value, one.name)) for one in fields(value)}
        return {"kind": value.kind, **own} if isinstance(value, Sentences | Table | Motions) else own
    return value
