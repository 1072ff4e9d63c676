"""The journal of a commissioning: what each step gave, so that an interrupted commissioning can go on.

It is a JSON file with a check, in the folder that also keeps logs, models and controllers. A step that is in the
journal is not done again; everything between the steps follows from their results alone.
"""

from __future__ import annotations

import fcntl
import json
import os
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from greywhale.base.errors import BAD_USAGE, UserError, os_reason
from greywhale.base.formats import json_text
from greywhale.base.formats.whole import write_text

NAME = "commission.json"
VERSION = 2


class CommissioningJournal:
    """Facts of the steps that are done, by the step's name. `request` says what was asked for."""

    def __init__(self, folder: Path, request: dict[str, Any], resume: bool) -> None:
        self.folder = folder
        self._path = folder / NAME
        self._request = json.loads(json.dumps(request))
        self._steps: dict[str, dict[str, Any]] = {}
        if resume:
            request, self._steps = self._read()
            self._require_same(request)
            return
        if self._path.exists() and self._read()[1]:
            raise UserError(
                f"{folder}: a commissioning is in this folder already; go on with it (--resume), or give another "
                "--out.",
                BAD_USAGE,
            )
        _make(folder)
        self._write()

    def get(self, step: str) -> dict[str, Any] | None:
        """The facts of a step, None where it was not done."""
        return self._steps.get(step)

    def note(self, step: str, facts: dict[str, Any]) -> None:
        """A step is done; the file is whole at any time."""
        self._steps[step] = facts
        self._write()

    def path(self, name: str) -> Path:
        """A file of this commissioning."""
        return self.folder / name

    def _write(self) -> None:
        check = _check(self._request, self._steps)
        book = {"greywhale_commission": VERSION, "request": self._request, "steps": self._steps, "check": check}
        write_text(self._path, json.dumps(book, indent=1, allow_nan=False) + "\n")

    def _read(self) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        """Request and steps of the journal in the folder."""
        try:
            book = json_text.loads(self._path.read_text(encoding="utf-8"))
            version, request, steps = book["greywhale_commission"], dict(book["request"]), dict(book["steps"])
        except FileNotFoundError:
            raise UserError(
                f"{self.folder}: no interrupted commissioning is there to go on with; leave --resume out.", BAD_USAGE
            ) from None
        except (OSError, ValueError, KeyError, TypeError):
            raise UserError(f"{self._path}: this is no journal of a commissioning; begin anew.", BAD_USAGE) from None
        if version != VERSION:
            raise UserError(f"{self._path}: it is of another version of greywhale; begin anew.", BAD_USAGE)
        if book.get("check") != _check(request, steps):
            raise UserError(f"{self._path}: the journal is damaged; begin anew.", BAD_USAGE)
        return request, steps

    def _require_same(self, request: dict[str, Any]) -> None:
        for key, value in self._request.items():
            if request.get(key) != value:
                raise UserError(
                    f"{self._path}: it was begun with {key} = {request.get(key)}, not {value}; give the same options, "
                    "or begin anew in another folder.",
                    BAD_USAGE,
                )


@contextmanager
def open_journal(folder: Path, request: dict[str, Any], resume: bool) -> Iterator[CommissioningJournal]:
    """A commissioning's journal, which no other commissioning can open meanwhile."""
    if not resume:
        _make(folder)
    with _held(folder):
        yield CommissioningJournal(folder, request, resume)


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"{folder}: cannot be made: {os_reason(error)}.", BAD_USAGE) from None


@contextmanager
def _held(folder: Path) -> Iterator[None]:
    """A lock on the folder, which the system takes away when this process ends, however it ends."""
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except OSError:  # CommissioningJournal says why
        yield
        return
    try:
        with suppress(OSError):  # a file system without locks
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise UserError(
                    f"{folder}: another greywhale is commissioning in this folder now; wait for its end, or give "
                    "another --out.",
                    BAD_USAGE,
                ) from None
        yield
    finally:
        os.close(descriptor)


def _check(request: dict[str, Any], steps: dict[str, dict[str, Any]]) -> str:
    return f"{zlib.crc32(json.dumps([request, steps], sort_keys=True).encode()):08x}"
