"""A file that is being written: it has no name before it is whole, so whatever kills its writer leaves nothing behind.

Where a file system knows no files without a name, and for the moment in which a file replaces another, the draft has a
hidden name, `.greywhale-*.new`. The writer holds a lock on it, which the system takes away when the writer ends,
however it ends. The next draft in the folder removes those that nobody holds.
"""

from __future__ import annotations

import contextlib
import errno
import logging
import os
import re
import secrets
from pathlib import Path
from typing import IO

from greywhale.base import system

logger = logging.getLogger(__name__)

_HIDDEN = re.compile(r"\.greywhale-[0-9a-f]{16}\.new")
# What a file system says that has no files without a name, or a kernel that does not know them.
_NEEDS_NAME = (errno.EOPNOTSUPP, errno.EISDIR, errno.EINVAL, errno.ENOENT)
_DESCRIPTORS = Path("/proc/self/fd")


class Draft:
    """An open, empty file for `target`, with the access rights that any new file of the user gets.

    It ends with `keep` or `discard`. OSError where `target` is not a file: a folder cannot be replaced, and a device
    (/dev/null) must not be.
    """

    def __init__(self, target: Path, buffering: int = -1) -> None:
        _refuse_others(target)
        sweep(target.parent)
        self.target = target
        self.path: Path | None = None  # its name, where it has one
        self._visible = False
        mode = "r+b" if buffering == 0 else "wb"
        self.file: IO[bytes] = open(self._create(), mode, buffering)  # noqa: SIM115 (until `keep` or `discard`)

    def show_as(self, path: Path) -> Path:
        """Give the draft a visible name, so that a kill no longer takes what is in it: `path`, or where that is taken
        a like one. The name taken.
        """
        number = 1
        name = path
        while True:
            try:
                self._link(name)
            except FileExistsError:
                number += 1
                name = path.with_name(f"{path.stem}-{number}{path.suffix}")
            else:
                self._visible = True
                return name

    def keep(self) -> None:
        """Give the file its name, so that no power cut can take either: OSError where the disk does not promise."""
        sync(self.file)
        size = os.fstat(self.file.fileno()).st_size
        if self.path is None:
            try:
                self._link(self.target)
            except FileExistsError:  # only a file with a name can replace another
                self._link(hidden_name(self.target.parent))
        if self.path != self.target:
            assert self.path is not None
            if not system.RENAMES_OPEN_FILES:
                self.file.close()
            os.replace(self.path, self.target)
            self.path = self.target
        sync_folder(self.target.parent)
        logger.info("%s: written, %d bytes", self.target, size)
        self.file.close()

    def discard(self) -> None:
        """Leave nothing, or of a draft that was shown what is in it."""
        with contextlib.suppress(OSError):
            self.file.close()
        if self.path is not None and self.path != self.target and not self._visible:
            with contextlib.suppress(OSError):
                self.path.unlink()

    def _create(self) -> int:
        """A locked descriptor: of a file without a name if that can be had."""
        if hasattr(os, "O_TMPFILE") and _DESCRIPTORS.is_dir():
            try:
                descriptor = os.open(self.target.parent, os.O_TMPFILE | os.O_RDWR, 0o666)
            except OSError as error:
                if error.errno not in _NEEDS_NAME or not self.target.parent.is_dir():
                    raise
            else:
                _lock(descriptor)
                return descriptor
        while True:
            self.path = hidden_name(self.target.parent)
            descriptor = system.open_plain(self.path, os.O_CREAT | os.O_EXCL | os.O_RDWR)
            _lock(descriptor)
            if os.fstat(descriptor).st_nlink:
                return descriptor
            os.close(descriptor)  # another one's sweep was quicker than the lock

    def _link(self, name: Path) -> None:
        """Give the draft this name; FileExistsError where it is taken."""
        if self.path is None:
            number = self.file.fileno()
            # Only with a folder's descriptor does Python ask the system for a link to what /proc points to; for an
            # absolute path its value does not matter.
            os.link(_DESCRIPTORS / str(number), name, src_dir_fd=number)
        elif os.path.lexists(name):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(name))
        else:
            os.rename(self.path, name)
        self.path = name


def sweep(folder: Path) -> None:
    """Remove the drafts in a folder whose writers were killed."""
    with contextlib.suppress(OSError):
        for name in filter(_HIDDEN.fullmatch, os.listdir(folder)):
            with contextlib.suppress(OSError):
                descriptor = system.open_plain(folder / name, os.O_RDWR)
                try:
                    system.lock(descriptor)
                    os.unlink(folder / name)
                finally:
                    os.close(descriptor)


def sync(file: IO[bytes]) -> None:
    """Have on the disk what was written."""
    file.flush()
    os.fsync(file.fileno())


def sync_folder(folder: Path) -> None:
    """Have the names in a folder on the disk, where its file system can promise that."""
    if not hasattr(os, "O_DIRECTORY"):
        return  # Windows opens no folder
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(descriptor)


def _refuse_others(target: Path) -> None:
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(target))
    if target.exists() and not target.is_file():
        raise OSError(errno.EINVAL, "not an ordinary file", str(target))


def hidden_name(folder: Path) -> Path:
    """A name in a folder that nothing has, for what gets its own when it is whole."""
    return folder / f".greywhale-{secrets.token_hex(8)}.new"


def _lock(descriptor: int) -> None:
    """Hold a draft, so that nobody sweeps it. A file system without locks has no sweeps either."""
    with contextlib.suppress(OSError):
        system.lock(descriptor, wait=True)
