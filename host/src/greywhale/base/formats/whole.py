"""Reads whole files only, and writes a file whole or not at all: it has no name before it is whole.

What was written is on the disk before it gets its name, and its name is too before the writer says so.
"""

from __future__ import annotations

import errno
import os
import shutil
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from greywhale.base.errors import BadUsage, UserError, os_reason
from greywhale.base.formats.draft import Draft, hidden_name, sync, sync_folder


def refuse_devices(path: str | Path) -> None:
    """Raise where `path` is a device or a pipe, which may never end. open() deals with folders and missing files."""
    mode = os.stat(path).st_mode
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
        raise OSError(errno.EINVAL, "not an ordinary file", str(path))


def refuse_inputs(out: Path | None, *inputs: str | Path | None) -> None:
    """Refuse to write over a file that is read from. (A name of an arm that comes with greywhale is no file.)"""
    for source in inputs:
        if out is not None and source is not None and out.exists() and Path(source).exists() and out.samefile(source):
            raise BadUsage(f"{out}: this file is read from; write elsewhere.")


def free_name(path: Path) -> Path:
    """This path, or the next that is free: name-2, name-3, ... A link that leads nowhere takes its name too."""
    number, free = 1, path
    while os.path.lexists(free):
        number += 1
        free = path.with_name(f"{path.stem}-{number}{path.suffix}")
    return free


def require_writable(path: Path) -> None:
    """OSError where `path` could not be written: no folder, no room, no permission, or not a file."""
    Draft(path).discard()


def write_whole(path: str | Path, write: Callable[[IO[bytes]], object]) -> None:
    """Let `write` fill the file; `path` appears, or is replaced, only when that went well."""
    try:
        draft = Draft(Path(path))
    except OSError as error:
        raise UserError(f"{path}: cannot be written: {os_reason(error)}.") from None
    try:
        write(draft.file)
        draft.keep()
    except OSError as error:
        raise UserError(f"{path}: cannot be written: {os_reason(error)}.") from None
    finally:
        draft.discard()


def write_text(path: str | Path, text: str) -> None:
    write_whole(path, lambda file: file.write(text.encode("utf-8")))


@contextmanager
def whole_folder(folder: Path) -> Iterator[Path]:
    """A folder to fill, which gets the name `folder`, or replaces it, when the context ends well, and else is gone."""
    draft, old = hidden_name(folder.parent), hidden_name(folder.parent)
    try:
        draft.mkdir()
        yield draft
        for path in draft.rglob("*"):
            if path.is_dir():
                sync_folder(path)
            else:
                with path.open("rb") as file:
                    sync(file)
        if folder.exists():
            folder.rename(old)
        draft.rename(folder)
        sync_folder(folder.parent)
    except OSError as error:
        raise UserError(f"{folder}: cannot be written: {os_reason(error)}.") from None
    finally:
        shutil.rmtree(draft, ignore_errors=True)
        if old.exists() and not folder.exists():
            old.rename(folder)
        shutil.rmtree(old, ignore_errors=True)


def make_folder(folder: Path) -> None:
    """Make a folder, and those above it, where it is not there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadUsage(f"{folder}: cannot be made: {os_reason(error)}.") from None
