"""The folder that a page's verbs work in: names from the page never lead out of it."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Literal, TypedDict

from greywhale.base.errors import BadUsage, UserError, cut, os_reason
from greywhale.base.formats.draft import sync_folder
from greywhale.base.formats.whole import free_name, write_whole
from greywhale.dashboard.file_kinds import KINDS_IN_WORDS, KNOWN_ENDS, kind_of_content, kind_of_file
from greywhale.dashboard.limits import REQUESTS

# The fate of a file that comes where one of its name is: it is refused, takes the place, or gets the next free name.
IfThere = Literal["refuse", "replace", "rename"]
IF_THERE: tuple[IfThere, ...] = ("refuse", "replace", "rename")


class FileFacts(TypedDict):
    """A file that a verb takes or writes; `kind` is log, motion, arm, model, controller, ..., picture or report."""

    name: str  # from the folder on
    kind: str
    size_bytes: int
    changed_s: float  # since 1970


class Folder:
    """A folder by its whole path, without links."""

    def __init__(self, path: Path) -> None:
        self.path = path.resolve()
        self._changing = threading.Lock()  # a name that is free stays so until it is taken

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
        for path in sorted([*self.path.glob("*"), *self.path.glob("*/*")])[: REQUESTS.most_files]:
            name, kind, size, changed_s = str(path.relative_to(self.path)), "", 0, 0.0
            if self._is_hidden(path):
                continue
            with contextlib.suppress(OSError, UserError):
                self.argument(name)
                kind = kind_of_file(path)
                facts = path.stat()
                size, changed_s = facts.st_size, facts.st_mtime
            if kind:
                found.append({"name": name, "kind": kind, "size_bytes": size, "changed_s": changed_s})
        return found

    def own(self, name: str) -> Path:
        """A file that a page may take away or change: one of those in `files`, and reached through no link."""
        path = self.file(name)
        if not path.is_file():
            raise BadUsage(f"{cut(name)}: no such file; it may be gone.")
        self._refuse_links(path, name)
        if self._is_hidden(path) or not kind_of_file(path):
            raise BadUsage(f"{cut(name)}: a page changes only files that verbs take or write; change it elsewhere.")
        return path

    def remove(self, name: str) -> None:
        with self._changing:
            path = self.own(name)
            with _told(name, "deleted"):
                path.unlink()
                sync_folder(path.parent)

    def rename(self, name: str, new: str) -> None:
        """Give a file another name of the same ending, where none is yet."""
        with self._changing:
            path, target = self.own(name), self._new(new)
            if target.suffix != path.suffix:
                raise BadUsage(f"{cut(new)}: a name must end with {path.suffix} as before; only that tells its kind.")
            if os.path.lexists(target):
                raise BadUsage(f"{cut(new)}: exists already; choose another name.")
            with _told(name, "renamed"):
                path.rename(target)
                sync_folder(target.parent)

    def receive(self, name: str, content: IO[bytes], if_there: IfThere) -> str:
        """Take the whole content of a file from a page; the name that it got."""
        target = self._new(name)
        if target.suffix not in KNOWN_ENDS or not kind_of_content(target.suffix, content):
            raise BadUsage(f"{cut(name)}: it is no file that a verb takes: {KINDS_IN_WORDS}; choose another file.")
        content.seek(0)
        with self._changing:
            if if_there == "rename":
                target = free_name(target)
            elif os.path.lexists(target):
                if if_there == "refuse":
                    raise BadUsage(f"{cut(name)}: exists already; replace it, or choose another name.")
                self.own(name)
            write_whole(target, lambda file: shutil.copyfileobj(content, file))
        return str(target.relative_to(self.path))

    def new_name(self, name: str) -> str:
        """This name, or the next that is free: name-2, name-3, ..."""
        return str(free_name(self._new(name)).relative_to(self.path))

    def _new(self, name: str) -> Path:
        """The path of a file that may be there or not, in a folder that is there."""
        path = self.file(name)
        self._refuse_links(path.parent, name)
        if self._is_hidden(path) or path == self.path:
            raise BadUsage(f"{cut(name)}: a page takes no hidden name; choose one that begins with a letter.")
        if not path.parent.is_dir():
            raise BadUsage(f"{cut(name)}: the folder {cut(str(path.parent))} does not exist; leave it out of the name.")
        return path

    def _is_hidden(self, path: Path) -> bool:
        return any(part.startswith(".") for part in path.relative_to(self.path).parts)

    def _refuse_links(self, path: Path, name: str) -> None:
        if path.resolve() != path:
            raise BadUsage(f"{cut(name)}: a link or .. leads there; give the name as the list has it.")


def spool() -> IO[bytes]:
    """A file without a name for what comes in pieces; it is gone when it is closed."""
    return tempfile.TemporaryFile()


@contextlib.contextmanager
def _told(name: str, done: str) -> Iterator[None]:
    """Tell an error of the system in a sentence."""
    try:
        yield
    except OSError as error:
        raise UserError(f"{cut(name)}: it cannot be {done}: {os_reason(error)}.") from None


def _leads_in_circle(path: Path) -> bool:
    """True if the links of a path lead in a circle; from Python 3.13 on `resolve` says nothing of it."""
    try:
        path.stat()
    except OSError as error:
        return error.errno == errno.ELOOP
    return False
