"""What the disassembly alone does not tell: how often loops run, and what excludes each other. From facts.toml."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from pathlib import Path

from tools.timing.listing import ImageError

FACTS = Path(__file__).with_name("facts.toml")


Part = tuple[str, str]  # a function, "" for the one that is asked about, and what happens in it: "call NAME", "loop N"


@dataclass(frozen=True)
class Piece:
    """What one call of the main loop's function may do: nothing of `never`.

    It begins at most `begins` microseconds after the timer's interrupt, or, without that, where the tick has ended; it
    reads so many received bytes at most. What it sends, if anything, it puts into the ring at its end.
    """

    never: tuple[Part, ...]
    begins: int | None
    reads: int
    sends: bool


@dataclass(frozen=True)
class Facts:
    """Loop bounds by plain function name, in the order of the loops' addresses; groups that exclude each other.

    A function that works more in one place than in another may have facts of its own for some callers, or for one of
    the calls there, as "CALLER 3": `for_callers` leads from caller and function to their key here. `limits` holds how
    often something runs in all, in one run of the function: "call NAME", "loop N" for its head, "entry N" for coming to
    the loop from outside.
    """

    loops: dict[str, list[int]] = field(default_factory=dict)
    exclusions: dict[str, list[list[str]]] = field(default_factory=dict)
    compiler: str = ""  # version of the GCC whose loops they are
    limits: dict[str, list[tuple[str, int]]] = field(default_factory=dict)
    for_callers: dict[tuple[str, str], str] = field(default_factory=dict)
    pieces: dict[str, Piece] = field(default_factory=dict)
    parts: dict[str, list[Part]] = field(default_factory=dict)  # of pieces

    def key(self, caller: str, site: int, function: str, signature: str = "") -> str:
        """Under what the facts about a function are when this one calls it, for the nth time by address."""
        known = self.for_callers.get((caller, function), signature if signature in self.loops else function)
        return self.for_callers.get((f"{caller} {site}", function), known)

    def times(self, function: str, found: list[str]) -> list[int]:
        """For each loop found in a function how often its head runs at most, for each time that it is entered."""
        known = self.loops.get(function, [])
        if len(known) != len(found):
            where = "; ".join(found) or "nowhere"
            raise ImageError(
                f"{function} has {len(found)} loops ({where}), but {len(known)} have a bound in {FACTS.name}."
            )
        return known

    def apart(self, function: str) -> list[list[str]]:
        return self.exclusions.get(function, [])


def load(path: Path = FACTS) -> Facts:
    """Reads the annotations; each needs its reason."""
    document = tomllib.loads(path.read_text())
    facts = Facts(compiler=document.get("compiler", ""))
    for entry in document.get("function", []):
        name = key = entry["name"]
        if callers := entry.get("called_by", []):
            key = f"{name}, called by {' or '.join(callers)}"
            facts.for_callers.update({(caller, name): key for caller in callers})
        for part in [*entry.get("loop", []), *entry.get("apart", []), *entry.get("limit", [])]:
            _need_reason(path, name, part)
        facts.loops[key] = [loop["times"] for loop in entry.get("loop", [])]
        facts.exclusions[key] = [part["what"] for part in entry.get("apart", [])]
        facts.limits[key] = [(part["what"], part["times"]) for part in entry.get("limit", [])]
    parts = facts.parts
    parts.update({name: [_part(what) for what in items] for name, items in document.get("parts", {}).items()})
    for entry in document.get("piece", []):
        _need_reason(path, entry["name"], entry)
        never = tuple(what for name, items in parts.items() if name not in entry["parts"] for what in items)
        facts.pieces[entry["name"]] = Piece(
            never, entry.get("begins"), entry.get("reads", 0), entry.get("sends", False)
        )
    return facts


def _part(text: str) -> Part:
    what, _, function = text.partition(" of ")
    return function, what


def _need_reason(path: Path, name: str, fact: dict[str, object]) -> None:
    if not fact.get("why"):
        raise ImageError(f"{path.name}: a fact about {name} has no reason.")
