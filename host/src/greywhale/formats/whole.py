"""Reads whole files only, and writes a file whole or not at all: into a temporary file beside it, then renamed.

What was written is on the disk before it gets its name, and its name is too before the writer says so.
"""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import IO

from greywhale.errors import BAD_USAGE, UserError, os_reason


def refuse_devices(path: str | Path) -> None:
    """Raise where `path` is a device or a pipe, which may never end. open() deals with folders and missing files."""
    mode = os.stat(path).st_mode
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
        raise OSError(errno.EINVAL, "not an ordinary file", str(path))


def refuse_inputs(out: Path | None, *inputs: str | Path | None) -> None:
    """Refuse to write over a file that is read from. (A name of an arm that comes with greywhale is no file.)"""
    for source in inputs:
        if out is not None and source is not None and out.exists() and Path(source).exists() and out.samefile(source):
            raise UserError(f"{out}: this file is read from; write elsewhere.", BAD_USAGE)


def temporary_beside(path: Path) -> tuple[int, str]:
    """An open, empty file in the folder of `path`, with the access rights that any new file of the user gets.

    Refused where `path` is not a file: a folder cannot be replaced, and a device (/dev/null) must not be.
    """
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if path.exists() and not path.is_file():
        raise OSError(errno.EINVAL, "not an ordinary file", str(path))
    descriptor, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
    mask = os.umask(0)
    os.umask(mask)
    os.chmod(name, 0o666 & ~mask)
    return descriptor, name


def keep(file: IO[bytes], temporary: str, target: Path) -> None:
    """Give a temporary file its name, so that no power cut can take either: OSError where the disk does not promise."""
    sync(file)
    os.replace(temporary, target)
    sync_folder(target.parent)


def sync(file: IO[bytes]) -> None:
    """Have on the disk what was written."""
    file.flush()
    os.fsync(file.fileno())


def sync_folder(folder: Path) -> None:
    """Have the names in a folder on the disk, where its file system can promise that."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(descriptor)


def write_whole(path: str | Path, write: Callable[[IO[bytes]], None]) -> None:
    """Let `write` fill the file; `path` appears, or is replaced, only when that went well."""
    target = Path(path)
    try:
        descriptor, name = temporary_beside(target)
    except OSError as error:
        raise UserError(f"{path}: cannot be written: {os_reason(error)}.") from None
    try:
        with open(descriptor, "wb") as file:
            write(file)
            keep(file, name, target)
    except OSError as error:
        _discard(name)
        raise UserError(f"{path}: cannot be written: {os_reason(error)}.") from None
    except BaseException:
        _discard(name)
        raise


def write_text(path: str | Path, text: str) -> None:
    """Write `text` as UTF-8."""
    write_whole(path, lambda file: _write_all(file, text.encode("utf-8")))


def _write_all(file: IO[bytes], data: bytes) -> None:
    file.write(data)


def _discard(name: str) -> None:
    with contextlib.suppress(OSError):
        os.unlink(name)
