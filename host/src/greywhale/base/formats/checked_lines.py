"""A file of JSON lines that only grows: what a long computation has found so far, so that it can go on after a kill.

The first line says what was asked for, each further one what was found. Every line has a check over itself and all
lines before (json_text.checked_line). A last line that a crash tore is forgotten; any other damage is refused, because
what follows may rest on it. While one program has the file, no other gets it.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from greywhale.base import system
from greywhale.base.closing import Closing
from greywhale.base.errors import UserError, os_reason
from greywhale.base.formats import json_text
from greywhale.base.formats.draft import sync, sync_folder
from greywhale.base.formats.whole import refuse_devices

Line = dict[str, Any]


@dataclass(frozen=True)
class Kind:
    """The purpose of a file, in the words of its sentences: `noun` of a `subject`, "journal" of a "tuning"."""

    mark: str  # the key in the first line that holds the version
    version: int
    noun: str
    subject: str
    anew: str  # what to do where the file cannot be used: "start anew without --resume"
    again: str  # how to go on after a full disk: "with --resume"
    is_line: Callable[[Line], bool]
    choices: tuple[str, ...] = ()  # of a request: where several differ, one of these is named


class CheckedLines(Closing):
    """An open file; `found` are the lines after the first that were there. Use as a context.

    With `keep` an existing file is gone on with: UserError where it is of another kind, version or request, or is
    damaged. Without it the file begins anew.
    """

    def __init__(self, path: Path, kind: Kind, request: dict[str, Any], keep: bool) -> None:
        self.path = path
        self.kind = kind
        self.found: list[Line] = []
        self._check = 0  # of the last line
        try:
            keep = keep and path.exists()
            if keep:
                refuse_devices(path)
            # A single unbuffered write a line: a crash can tear the last one only.
            self._file: IO[bytes] = path.open("r+b" if keep else "ab", buffering=0)
            try:
                self._lock()
                self._begin({kind.mark: kind.version, "request": request}, keep)
                sync_folder(path.parent)
            except BaseException:
                self._file.close()
                raise
        except OSError as error:
            raise UserError(f"{path}: cannot be used as a {kind.noun}: {os_reason(error)}.") from None

    def append(self, line: Line) -> None:
        """Add a line; when this returns it is on its way to the disk."""
        data, check = json_text.checked_line(line, self._check)
        try:
            self._file.write(data)
        except OSError as error:
            raise self._cannot_be_written(error) from None
        self._check = check

    def close(self) -> None:
        """Close the file; it is on the disk then."""
        if self._file.closed:
            return
        try:
            sync(self._file)
        except OSError as error:
            raise self._cannot_be_written(error) from None
        finally:
            self._file.close()

    def _lock(self) -> None:
        """The system takes the lock away when this process ends, however it ends."""
        try:
            system.lock(self._file.fileno())
        except BlockingIOError:
            raise UserError(f"{self.path}: another greywhale is using this {self.kind.noun} now.") from None
        except OSError:
            pass  # a file system without locks

    def _begin(self, heading: Line, keep: bool) -> None:
        content = self._file.read() if keep else b""
        length = content.rfind(b"\n") + 1
        lines = self._checked(content[:length])
        if lines:
            self._require_same(lines[0], heading)
            self.found = lines[1:]
            self._file.truncate(length)
            self._file.seek(length)
            return
        # It ends within its first line, so nothing was told yet; but what never was such a file is somebody's.
        if not json_text.checked_line(heading, 0)[0].startswith(content):
            raise self._bad(1, f"is not a line of a {self.kind.subject}'s {self.kind.noun}")
        if os.fstat(self._file.fileno()).st_size:  # a device has none, and cannot be cut
            self._file.truncate(0)
            self._file.seek(0)
        self._check = 0
        self.append(heading)

    def _checked(self, content: bytes) -> list[Line]:
        """Whole lines as what they say; the check of the last is kept."""
        lines: list[Line] = []
        for number, line in enumerate(content.split(b"\n")[:-1], start=1):
            value = _object(line)
            good = value is not None and (
                isinstance(value.get("request"), dict) if number == 1 else self.kind.is_line(value)
            )
            if good and value is not None and number == 1 and value.get(self.kind.mark) != self.kind.version:
                raise UserError(
                    f"{self.path}: this {self.kind.noun} is of another version of greywhale; {self.kind.anew}."
                )
            check = json_text.check_of(line, self._check)
            if not good or value is None or check is None:
                raise self._bad(
                    number, "is damaged" if good else f"is not a line of a {self.kind.subject}'s {self.kind.noun}"
                )
            self._check = check
            lines.append({key: one for key, one in value.items() if key != "check"})
        return lines

    def _bad(self, number: int, what: str) -> UserError:
        remedy = f"remove it and all lines after it, or {self.kind.anew}" if number > 1 else self.kind.anew
        return UserError(f"{self.path}: line {number} {what}; {remedy}.")

    def _require_same(self, found: Line, wanted: Line) -> None:
        # Compare in the form that JSON gives: tuples become lists there.
        now = json.loads(json.dumps(wanted["request"]))
        then = found["request"]
        # Name a difference in the user's choices first; the others follow from them.
        for key in sorted({*now, *then}, key=lambda name: (name not in self.kind.choices, name)):
            if now.get(key) != then.get(key):
                raise UserError(
                    f"{self.path}: the {self.kind.noun} is of another {self.kind.subject}: its {key} is "
                    f"{_short(then.get(key))}, now it is {_short(now.get(key))}; give the same again, or "
                    f"{self.kind.anew}."
                )

    def _cannot_be_written(self, error: OSError) -> UserError:
        return UserError(f"{self.path}: cannot be written: {os_reason(error)}; make room and go on {self.kind.again}.")


def _object(line: bytes) -> Line | None:
    try:
        value = json_text.loads(line)
    except ValueError:
        return None
    return value if isinstance(value, dict) else None


def _short(value: object) -> str:
    text = "not given" if value is None else json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
