"""The kinds of picture files. It needs no Matplotlib, which takes a second to import."""

from __future__ import annotations

from pathlib import Path

from greywhale.base.errors import BadUsage

# Each kind, and the entry of its metadata that would make two pictures of the same numbers differ.
CHANGING = {".png": "Software", ".svg": "Date", ".pdf": "CreationDate"}
KINDS = tuple(CHANGING)


def kind_of(path: Path) -> str:
    """The ending of a picture, such as .png; another one is refused."""
    kind = path.suffix.lower()
    if kind not in CHANGING:
        raise BadUsage(f"{path}: pictures end in {', '.join(KINDS)}.")
    return kind
