"""Tells the kind of a file by the end of its name and by its content."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from greywhale.base.errors import UserError
from greywhale.base.formats import toml_file
from greywhale.base.formats.kinds import kind_of
from greywhale.dashboard.limits import REQUESTS
from greywhale.files.log.layout import TITLE

# Of files whose content tells no kind.
_BY_END = {".png": "picture", ".svg": "picture", ".pdf": "picture", ".html": "report"}
# The ends of files that a verb takes, so that a page may bring them.
KNOWN_ENDS = (".csv", ".toml", ".hex")
KINDS_IN_WORDS = "a log or motion (.csv), an arm, model, controller or backup (.toml), firmware (.hex)"


def kind_of_file(path: Path) -> str:
    """The kind of a file that a verb takes or writes, "" of any other, and of what cannot be read."""
    with contextlib.suppress(OSError):
        if path.is_file() and path.suffix in (*KNOWN_ENDS, *_BY_END):
            with path.open("rb") as file:
                return _BY_END.get(path.suffix) or kind_of_content(path.suffix, file)
    return ""


def kind_of_content(end: str, file: IO[bytes]) -> str:
    """The kind that a file's content tells, from its beginning on."""
    file.seek(0)
    with contextlib.suppress(ValueError, UserError):
        if end == ".csv":
            return next(_kinds_of_csv(file), "")
        if end == ".hex":
            return "firmware" if file.read(1) == b":" else ""
        table = file.read(REQUESTS.largest_table_bytes + 1)
        if end == ".toml" and len(table) <= REQUESTS.largest_table_bytes:
            kind = kind_of(toml_file.parse(table.decode("utf-8"), "the table"))
            return "" if kind is None else kind.name.lower()
    return ""


def _kinds_of_csv(file: IO[bytes]) -> Iterator[str]:
    first = _line(file, 200)
    if TITLE in first:
        yield "log"
    while first.startswith("#"):
        first = _line(file, 4000)
    if first.startswith("time_s,leader_0"):
        yield "motion"


def _line(file: IO[bytes], most: int) -> str:
    return file.readline(most).decode("utf-8", "replace")  # a letter may be cut
