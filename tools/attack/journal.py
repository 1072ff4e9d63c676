"""What the attacks have done so far, a line for each piece: attacks that were interrupted go on from it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from tools.attack.part import Part, Piece, Row
from tools.sources import digest_of


@dataclass(frozen=True)
class Done:
    """A finished piece: its rows, and how long a worker took over it."""

    piece: Piece
    rows: list[Row]
    seconds: float = 0.0


def identity(part: Part) -> str:
    """A digest of all that a part's result is about."""
    return digest_of((*part.depends, f"tools/attack/parts/{part.name}.py"))


class Journal:
    """The finished pieces of one part, in a file that another state of the code does not share."""

    def __init__(self, folder: Path, part: Part) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.path = folder / f"{part.name}-{identity(part)}.jsonl"
        self._done: dict[str, Done] = {}
        if self.path.exists():
            whole, _, torn = self.path.read_text(encoding="utf-8").rpartition("\n")
            if torn:  # it was being written when they were killed
                self.path.write_text(whole + "\n", encoding="utf-8")
            self._done = {_key(done.piece): done for done in _read(whole)}

    def take_over(self, folder: Path) -> int:
        """Add what was done elsewhere for the same state of the code, another machine's folder; how many pieces."""
        other = folder / self.path.name
        text = other.read_text(encoding="utf-8") if other.exists() else ""
        new = [done for done in _read(text.rpartition("\n")[0]) if self.missing([done.piece])]
        for done in new:
            self.add(done)
        return len(new)

    def add(self, done: Done) -> None:
        self._done[_key(done.piece)] = done
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(asdict(done)) + "\n")

    def missing(self, pieces: Iterable[Piece]) -> list[Piece]:
        return [piece for piece in pieces if _key(piece) not in self._done]

    def rows(self, pieces: Iterable[Piece]) -> list[Row]:
        """The rows of these pieces that are done, in their order."""
        return [row for done in self._of(pieces) for row in done.rows]

    def seconds(self, pieces: Iterable[Piece]) -> float:
        """How long these pieces took, those that are done."""
        return sum(done.seconds for done in self._of(pieces))

    def _of(self, pieces: Iterable[Piece]) -> Iterator[Done]:
        return (self._done[key] for key in map(_key, pieces) if key in self._done)


def _read(text: str) -> Iterator[Done]:
    """The pieces of whole lines."""
    for entry in map(json.loads, text.splitlines()):
        yield Done(entry["piece"], [Row(**row) for row in entry["rows"]], entry.get("seconds", 0.0))


def _key(piece: Piece) -> str:
    return json.dumps(piece, sort_keys=True)
