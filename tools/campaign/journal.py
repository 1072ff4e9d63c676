"""What the campaign has done so far, a line for each piece: a campaign that was interrupted goes on from it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from pathlib import Path

from tools.campaign.part import Part, Piece, Row
from tools.sources import digest_of

ROOT = Path(__file__).parents[2]


def identity(part: Part) -> str:
    """A digest of all that a part's result is about."""
    return digest_of((*part.depends, f"tools/campaign/parts/{part.name}.py"))


class Journal:
    """The finished pieces of one part, in a file that another state of the code does not share."""

    def __init__(self, folder: Path, part: Part) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.path = folder / f"{part.name}-{identity(part)}.jsonl"
        self._done: dict[str, list[Row]] = {}
        if self.path.exists():
            whole, _, torn = self.path.read_text(encoding="utf-8").rpartition("\n")
            if torn:  # it was being written when the campaign was killed
                self.path.write_text(whole + "\n", encoding="utf-8")
            self._done = {_key(piece): rows for piece, rows in _read(whole)}

    def take_over(self, folder: Path) -> int:
        """Add what was done elsewhere for the same state of the code, another machine's folder; how many pieces."""
        other = folder / self.path.name
        text = other.read_text(encoding="utf-8") if other.exists() else ""
        new = [(piece, rows) for piece, rows in _read(text.rpartition("\n")[0]) if self.missing([piece])]
        for piece, rows in new:
            self.add(piece, rows)
        return len(new)

    def add(self, piece: Piece, rows: Iterable[Row]) -> None:
        self._done[_key(piece)] = list(rows)
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps({"piece": piece, "rows": [asdict(row) for row in rows]}) + "\n")

    def missing(self, pieces: Iterable[Piece]) -> list[Piece]:
        return [piece for piece in pieces if _key(piece) not in self._done]

    def rows(self, pieces: Iterable[Piece]) -> list[Row]:
        """The rows of these pieces that are done, in their order."""
        return [row for piece in pieces for row in self._done.get(_key(piece), [])]


def _read(text: str) -> Iterator[tuple[Piece, list[Row]]]:
    """Each piece of whole lines, and its rows."""
    for entry in map(json.loads, text.splitlines()):
        yield entry["piece"], [Row(**row) for row in entry["rows"]]


def _key(piece: Piece) -> str:
    return json.dumps(piece, sort_keys=True)
