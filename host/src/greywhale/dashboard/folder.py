"""The folder that a page's verbs work in: names from the page never lead out of it."""

from __future__ import annotations

import contextlib
import errno
from collections.abc import Iterator
from pathlib import Path
from typing import TypedDict

from greywhale.base.errors import BadUsage, UserError, cut, os_reason
from greywhale.base.formats import toml_file
from greywhale.base.formats.kinds import kind_of
from greywhale.files.log.layout import TITLE

MOST_FILES = 1000  # that are looked at, in and below the folder
# Larger tables are nobody's that a page would name.
_LARGEST_TABLE_BYTES = 1 << 20


class FileFacts(TypedDict):
    """A file that some verb takes; `kind` is log, motion, or a kind of table: arm, model, controller, ..."""

    name: str  # from the folder on
    kind: str


class Folder:
    """A folder by its whole path, without links."""

    def __init__(self, path: Path) -> None:
        self.path = path.resolve()

    def inside(self, name: str) -> Path:
        """The whole path of a name; one that leads out of the folder is refused, also through a link."""
        whole = self.path / name if name and name.isprintable() else None
        shown = cut(name if name.isprintable() else repr(name))
        if whole is not None and _leads_in_circle(whole):
            raise BadUsage(f"{cut(name)}: its links lead in a circle; name another file.")
        if whole is None or not whole.resolve().is_relative_to(self.path):
            raise BadUsage(
                f"{shown or 'an empty name'}: it is not in {self.path}; name a file there, or start the dashboard "
                "with another --folder."
            )
        return whole

    def file(self, name: str) -> Path:
        """The path of a file that is to be read now; a name that no file can have is refused."""
        whole = self.inside(name)
        try:
            whole.is_file()
        except OSError as error:
            raise BadUsage(f"{cut(name)}: it cannot be read: {os_reason(error)}; name another file.") from None
        return whole

    def argument(self, text: str) -> None:
        """Refuse a verb's argument that leads out of the folder: any text may be a name, and what follows a "=" too."""
        for name in (text, text.rpartition("=")[2] or text):
            self.inside(name)

    def files(self) -> list[FileFacts]:
        """The files that verbs could take, here and one folder down, by name."""
        found: list[FileFacts] = []
        for path in sorted([*self.path.glob("*"), *self.path.glob("*/*")])[:MOST_FILES]:
            name, kind = str(path.relative_to(self.path)), ""
            with contextlib.suppress(UserError):
                self.argument(name)
                kind = _kind(path)
            if kind and not path.name.startswith("."):
                found.append({"name": name, "kind": kind})
        return found


def _leads_in_circle(path: Path) -> bool:
    """True if the links of a path lead in a circle; from Python 3.13 on `resolve` says nothing of it."""
    try:
        path.stat()
    except OSError as error:
        return error.errno == errno.ELOOP
    return False


def _kind(path: Path) -> str:
    """The kind of a file, "" for one that no verb takes."""
    with contextlib.suppress(OSError, UserError, ValueError):
        if path.suffix == ".csv" and path.is_file():
            return next(_kinds_of_csv(path), "")
        if path.suffix == ".toml" and path.is_file() and path.stat().st_size <= _LARGEST_TABLE_BYTES:
            kind = kind_of(toml_file.read(path))
            return "" if kind is None else kind.name.lower()
    return ""


def _kinds_of_csv(path: Path) -> Iterator[str]:
    with path.open(encoding="utf-8") as file:
        first = file.readline(200)
        if TITLE in first:
            yield "log"
        while first.startswith("#"):
            first = file.readline(4000)
        if first.startswith("time_s,leader_0"):
            yield "motion"
