"""Short names that tell files apart."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

_LONGEST = 30  # letters


def distinct_names(files: Sequence[str]) -> list[str]:
    """A name for each file: without folders and ending where that is enough, else with the folders that it takes.

    What is only one file, given twice, is counted: "log, 1" and "log, 2".
    """
    paths = [Path(file).absolute() for file in files]
    names = [_shortest(path, set(paths) - {path}) for path in paths]
    return [
        f"{name}, {names[: at + 1].count(name)}" if names.count(name) > 1 else name for at, name in enumerate(names)
    ]


def _shortest(path: Path, others: set[Path]) -> str:
    """The stem, or the fewest last parts of the path that no other has; a long way between them is left out."""
    if all(other.stem != path.stem for other in others):
        return _cut(path.stem)
    same = {other for other in others if other.stem == path.stem}
    if all(other.name != path.name for other in same):
        return _cut(path.name)
    for length in range(2, len(path.parts) + 1):
        own = path.parts[-length:]
        if all(other.parts[-length:] != own for other in same):
            return _cut(own[0]) + ("/" if length == 2 else "/…/") + _cut(path.stem)
    return _cut(path.name)


def _cut(word: str) -> str:
    return word if len(word) <= _LONGEST else f"{word[: _LONGEST // 2]}…{word[-_LONGEST // 2 + 1 :]}"
