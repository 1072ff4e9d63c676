"""The folder for what runs now: links to benches. It belongs to this user alone."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from greywhale.base import system
from greywhale.base.errors import UserError, os_reason

# Names another folder, for tests: what runs in it is found only by those who name it too.
VARIABLE = "GREYWHALE_RUNTIME_DIR"


def runtime_directories() -> list[Path]:
    """The folders that may be used. They follow from the user alone: a cron job has another environment."""
    given = os.environ.get(VARIABLE)
    if given:
        return [Path(given)]
    return [Path(f"/run/user/{system.user()}/greywhale"), Path(f"/tmp/greywhale-{system.user()}")]


def make_runtime_directory() -> Path:
    """The first folder that can be had, made where it is missing; a UserError where others could change all of them."""
    *better, last = runtime_directories()
    for folder in better:
        try:
            return _make(folder)
        except UserError:
            continue
    return _make(last)


def _make(folder: Path) -> Path:
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
    except OSError as error:
        raise UserError(f"{folder}: cannot be made: {os_reason(error)}.") from None
    problem = _why_not_private(folder)
    if problem is not None:
        raise UserError(f"{folder}: {problem}; remove it, or give it back to yourself with mode 700.")
    return folder


def private_runtime_directories() -> list[Path]:
    """The folders that are there and can be trusted: a bench may have begun before /run/user/UID was there."""
    return [folder for folder in runtime_directories() if _why_not_private(folder) is None]


def _why_not_private(folder: Path) -> str | None:
    """The reason why a folder is not this user's alone. A link is no folder: its owner could turn it elsewhere."""
    try:
        found = folder.lstat()
    except OSError as error:
        return f"cannot be used: {os_reason(error)}"
    if not stat.S_ISDIR(found.st_mode):
        return "is not a folder"
    if found.st_uid != system.user():
        return "belongs to another user"
    if found.st_mode & 0o077:
        return f"is open to other users (mode {stat.S_IMODE(found.st_mode):o})"
    return None
