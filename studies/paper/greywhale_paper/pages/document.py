"""The report as a document: chapters of entries, each a table or figure of the paper with what was found for it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any


class Status(Enum):
    """What became of a table or figure of the paper."""

    COMPUTED = "computed anew"
    MEASURED = "measured anew on the bench"
    DRAWN = "drawn from the text"
    OPEN = "cannot be reproduced"
    OURS = "our own check"


@dataclass(frozen=True)
class Row:
    """A line of a sheet; a heading has its label alone."""

    label: str
    cells: tuple[str, ...] = ()

    @property
    def heading(self) -> bool:
        return not self.cells


@dataclass(frozen=True)
class Sheet:
    """A table: `columns` has the label's column first; `printed` are the columns (by place) that the paper prints."""

    columns: Sequence[str]
    rows: Sequence[Row]
    printed: Collection[int] = ()
    notes: Sequence[str] = ()

    def __post_init__(self) -> None:
        for row in self.rows:
            if row.cells and len(row.cells) + 1 != len(self.columns):
                raise ValueError(f"{row.label!r} has {len(row.cells)} cells for {len(self.columns) - 1} columns")

    @property
    def texts(self) -> frozenset[int]:
        """The columns (by place) of words, which begin at the left; numbers end at the right."""
        found = {0}
        for place in range(1, len(self.columns)):
            cells = [row.cells[place - 1] for row in self.rows if row.cells and row.cells[place - 1]]
            if cells and 2 * sum(cell[0].isalpha() or cell[0] == "{" or ";" in cell for cell in cells) > len(cells):
                found.add(place)
        return frozenset(found)

    def as_dict(self) -> dict[str, Any]:
        return {
            "columns": list(self.columns),
            "rows": [[row.label, *row.cells] for row in self.rows],
            "printed": sorted(self.printed),
            "notes": list(self.notes),
        }


@dataclass(frozen=True)
class Picture:
    """A PNG, and what it shows for those who cannot see it."""

    png: bytes
    shows: str

    def as_dict(self) -> dict[str, Any]:
        return {"shows": self.shows}


@dataclass(frozen=True)
class Words:
    paragraphs: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        return {"text": list(self.paragraphs)}


@dataclass(frozen=True)
class Code:
    """Lines to be shown as they are."""

    lines: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        return {"code": list(self.lines)}


Block = Sheet | Picture | Words | Code


@dataclass(frozen=True)
class Entry:
    """One table or figure of the paper: its number, what it is, what became of it."""

    label: str
    title: str
    status: Status
    blocks: tuple[Block, ...]

    def as_dict(self) -> dict[str, Any]:
        return {
            "label": self.label,
            "title": self.title,
            "status": self.status.value,
            "blocks": [block.as_dict() for block in self.blocks],
        }

    @property
    def anchor(self) -> str:
        """Its name in links."""
        return "".join(letter if letter.isalnum() else "-" for letter in (self.label or self.title).lower())


@dataclass(frozen=True)
class Chapter:
    """Entries under one title."""

    title: str
    entries: tuple[Entry, ...]


@dataclass(frozen=True)
class Document:
    """The whole report; `about` are sentences on top."""

    title: str
    about: tuple[str, ...]
    chapters: tuple[Chapter, ...]

    @property
    def entries(self) -> list[Entry]:
        return [entry for chapter in self.chapters for entry in chapter.entries]

    def as_dict(self) -> dict[str, Any]:
        return {
            "title": self.title,
            "about": list(self.about),
            "chapters": [
                {"title": chapter.title, "entries": [entry.as_dict() for entry in chapter.entries]}
                for chapter in self.chapters
            ],
        }


def words(*paragraphs: str) -> Words:
    return Words(paragraphs)
