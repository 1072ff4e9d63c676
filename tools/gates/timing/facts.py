"""Facts that the disassembly does not tell, from facts.toml: how often loops run, and what excludes each other."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from pathlib import Path

from tools.gates.timing.listing import ImageError

FACTS = Path(__file__).with_name("facts.toml")


@dataclass(frozen=True)
class Facts:
    """Loop bounds by plain function name, in the order of the loops' addresses; groups that exclude each other."""

    loops: dict[str, list[int]] = field(default_factory=dict)
    exclusions: dict[str, list[list[str]]] = field(default_factory=dict)
    compilers: tuple[str, ...] = ()  # versions of GCC whose loops they are

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
    facts = Facts(compilers=tuple(document.get("compilers", ())))
    for entry in document.get("function", []):
        name = entry["name"]
        for part in [*entry.get("loop", []), *entry.get("apart", [])]:
            _need_reason(path, name, part)
        facts.loops[name] = [loop["times"] for loop in entry.get("loop", [])]
        facts.exclusions[name] = [part["what"] for part in entry.get("apart", [])]
    return facts


def _need_reason(path: Path, name: str, fact: dict[str, object]) -> None:
    if not fact.get("why"):
        raise ImageError(f"{path.name}: a fact about {name} has no reason.")
