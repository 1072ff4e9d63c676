"""Outputs are checked before the work whose result they take, not after it: one sentence, and bad usage, everywhere."""

from __future__ import annotations

from pathlib import Path

from greywhale.base.errors import BadUsage, os_reason
from greywhale.base.formats.whole import require_writable


def require_new(overwrite: bool, *paths: Path | None) -> None:
    """`require_files`, and refuse files that are there already, unless `overwrite`: somebody may need them."""
    require_files(*paths)
    for path in paths:
        if path is not None and not overwrite and path.exists():
            raise BadUsage(f"{path}: exists already; write over it with --overwrite, or name another file.")


def require_no_files(overwrite: bool, folder: Path | None, *patterns: str) -> None:
    """Refuse a folder with files of these names, such as `responses_*.png`, unless `overwrite`."""
    for pattern in patterns if folder is not None and not overwrite else ():
        assert folder is not None
        for path in sorted(folder.glob(pattern)):
            raise BadUsage(f"{path}: exists already; write over it with --overwrite, or name another folder.")


def require_new_folder(overwrite: bool, folder: Path, *names: str) -> None:
    """Refuse a folder that could not be made, and one that is there, unless `overwrite` and it holds `names` alone."""
    require_folder(folder, "results")
    held = {path.name for path in folder.iterdir()} if folder.exists() else set()
    if held and not overwrite:
        raise BadUsage(f"{folder}: exists already; write over it with --overwrite, or name another folder.")
    if others := sorted(held - set(names)):
        raise BadUsage(f"{folder}: it also holds {others[0]}, which --overwrite would take; name another folder.")


def require_files(*paths: Path | None) -> None:
    """Refuse files that could not be written; None is one that nobody asked for. Nothing is left behind."""
    for path in paths:
        if path is None:
            continue
        if str(path) == "-":
            raise BadUsage("-: a result goes into a file, never to standard output; name one (./- is a file named -).")
        if not path.parent.is_dir():
            gone = "is not a folder; name one" if path.parent.exists() else "does not exist; create it"
            there = "" if path.parent.exists() else "the folder "
            raise BadUsage(f"{path}: {there}{path.parent} {gone}, or write elsewhere.")
        if path.is_dir():
            raise BadUsage(f"{path}: this is a folder; name a file in it.")
        try:
            require_writable(path)
        except OSError as error:
            raise BadUsage(f"{path}: cannot be written: {os_reason(error)}; write elsewhere.") from None


def require_folder(folder: Path | None, what: str, *names: str) -> None:
    """Refuse a folder that could not be made, or in which the files `names` could not be written.

    `what` goes into it, as a plural: "pictures". The folder is not made yet.
    """
    if folder is None:
        return
    if folder.is_dir():
        require_files(folder / "new", *(folder / name for name in names))
        return
    if folder.exists():
        raise BadUsage(f"{folder}: {what} go into a folder, and this is a file.")
    above = next(one for one in folder.absolute().parents if one.exists())
    if not above.is_dir():
        raise BadUsage(f"{folder}: {above} is not a folder; write elsewhere.")
    try:
        require_writable(above / "new")
    except OSError as error:
        raise BadUsage(f"{folder}: cannot be made: {os_reason(error)}; write elsewhere.") from None
