"""The folder for what runs now: sockets of sessions, links to benches. It belongs to this user alone."""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path

from greywhale.errors import UserError, os_reason


def runtime_directory() -> Path:
    """Where the folder is: in the user's runtime directory, else with a name of the user's in the temporary folder."""
    given = os.environ.get("XDG_RUNTIME_DIR", "")
    # After a change of user (su, sudo -E) the variable may still name the folder of another.
    if given and _why_not_private(Path(given)) is None:
        return Path(given) / "greywhale"
    return Path(tempfile.gettempdir()) / f"greywhale-{os.getuid()}"


def make_runtime_directory() -> Path:
    """The folder, made where it is missing; a UserError where another user could change what lies in it."""
    folder = runtime_directory()
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
    except OSError as error:
        raise UserError(f"{folder}: cannot be made: {os_reason(error)}.") from None
    problem = _why_not_private(folder)
    if problem is not None:
        raise UserError(f"{folder}: {problem}; remove it, or give it back to yourself with mode 700.")
    return folder


def private_runtime_directory() -> Path | None:
    """The folder where it is there and can be trusted, else None."""
    folder = runtime_directory()
    return folder if _why_not_private(folder) is None else None


def _why_not_private(folder: Path) -> str | None:
    """What keeps a folder from being this user's alone. A link is no folder: its owner could turn it elsewhere."""
    try:
        found = folder.lstat()
    except OSError as error:
        return f"cannot be used: {os_reason(error)}"
    if not stat.S_ISDIR(found.st_mode):
        return "is not a folder"
    if found.st_uid != os.getuid():
        return "belongs to another user"
    if found.st_mode & 0o077:
        return f"is open to other users (mode {stat.S_IMODE(found.st_mode):o})"
    return None
