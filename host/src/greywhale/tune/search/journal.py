"""The journal of a tuning: every cost that an optimiser was told, so that an interrupted tuning can go on.

It is a file of JSON lines, each with a check over itself and all lines before. The first says what was asked for. Each
further line holds the costs of one batch and a digest of its candidates. Resuming plays the optimisers through the same
batches with the costs from the file, without simulation, and then goes on. File and result become the same, byte for
byte, as those of a run without a break.
"""

from __future__ import annotations

import json
import os
import zlib
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self

import numpy as np
import numpy.typing as npt

from greywhale.errors import UserError, os_reason
from greywhale.formats import json_text
from greywhale.formats.draft import sync, sync_folder
from greywhale.formats.whole import refuse_devices

Floats = npt.NDArray[np.float64]
Controllers = npt.NDArray[np.int32]

VERSION = 3
_CHOSEN = ("strategy", "method", "budget", "seed", "bounds", "before")


class Journal:
    """The costs in the order in which they are told. Without a path nothing is kept. Use as a context."""

    def __init__(self, path: Path | None, request: dict[str, Any], resume: bool = False) -> None:
        self._path = path
        self._told: list[dict[str, Any]] = []
        self._next = 0
        self._file: IO[bytes] | None = None
        self._check = 0  # of the last line
        if path is None:
            return
        heading = {"greywhale_tune_journal": VERSION, "request": request}
        try:
            if resume and path.exists():
                self._file = self._reopened(path, heading)
            else:
                self._file = path.open("wb", buffering=0)
                self._write(heading)
            sync_folder(path.parent)
        except OSError as error:
            raise UserError(f"{path}: cannot be used as a journal: {os_reason(error)}.") from None

    @property
    def replaying(self) -> bool:
        """Whether the next batch's costs are known already."""
        return self._next < len(self._told)

    def costs(self, stage: str, candidates: Controllers) -> Floats | None:
        """The costs of the next batch, if the journal has them."""
        if not self.replaying:
            return None
        line = self._told[self._next]
        if line["stage"] != stage or line["candidates"] != _digest(candidates):
            raise UserError(
                f"{self._path}: batch {self._next + 1} of the journal is of other candidates ({line['stage']}) than "
                f"this version of greywhale asks for ({stage}); start anew without --resume."
            )
        self._next += 1
        return np.array(line["costs"], dtype=np.float64)

    def tell(self, stage: str, candidates: Controllers, costs: Floats) -> None:
        """Append a batch's costs; when this returns they are on their way to the disk."""
        if self._file is not None:
            self._write({"stage": stage, "candidates": _digest(candidates), "costs": costs.tolist()})

    def close(self) -> None:
        """Close the file; it is on the disk then."""
        if self._file is None:
            return
        file, self._file = self._file, None
        try:
            sync(file)
        except OSError as error:
            raise self._cannot_be_written(error) from None
        finally:
            file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _write(self, line: dict[str, Any]) -> None:
        assert self._file is not None
        data, self._check = json_text.checked_line(line, self._check)
        # A single unbuffered write: a crash can tear the last line only.
        try:
            self._file.write(data)
        except OSError as error:
            raise self._cannot_be_written(error) from None

    def _cannot_be_written(self, error: OSError) -> UserError:
        return UserError(f"{self._path}: cannot be written: {os_reason(error)}; make room and go on with --resume.")

    def _reopened(self, path: Path, heading: dict[str, Any]) -> IO[bytes]:
        refuse_devices(path)
        whole = path.read_bytes()
        lines, length, self._check = _whole_lines(path, whole)
        if not lines:
            # It ends within its first line: nothing was told yet.
            self._check = 0
            file = path.open("wb", buffering=0)
            self._file = file
            self._write(heading)
            return file
        _require_same(path, lines[0], heading)
        self._told = lines[1:]
        os.truncate(path, length)
        return path.open("ab", buffering=0)


def _whole_lines(path: Path, content: bytes) -> tuple[list[dict[str, Any]], int, int]:
    """The lines that were written to their end, their length in bytes, and the check of the last; a torn last line is
    dropped. A line that is damaged is refused: what follows it may rest on it.
    """
    length = content.rfind(b"\n") + 1
    lines: list[dict[str, Any]] = []
    check = 0
    for number, line in enumerate(content[:length].split(b"\n")[:-1], start=1):
        try:
            value = json_text.loads(line)
        except ValueError:
            value = None
        good = isinstance(value, dict) and (isinstance(value.get("request"), dict) if number == 1 else _is_batch(value))
        if good and number == 1:
            _require_this_version(path, value)
        found = json_text.check_of(line, check)
        if not good or found is None:
            what = "is damaged" if good else "is not a line of a tuning's journal"
            remedy = "remove it and all lines after it, or start anew" if number > 1 else "start anew"
            raise UserError(f"{path}: line {number} {what}; {remedy} without --resume.")
        check = found
        lines.append(value)
    return lines, length, check


def _is_batch(value: dict[str, Any]) -> bool:
    costs = value.get("costs")
    return (
        isinstance(value.get("stage"), str)
        and isinstance(value.get("candidates"), int)
        and isinstance(costs, list)
        and bool(costs)
        and all(isinstance(row, list) and len(row) == 4 for row in costs)
        and all(isinstance(cost, float) for row in costs for cost in row)
    )


def _require_this_version(path: Path, heading: dict[str, Any]) -> None:
    if heading.get("greywhale_tune_journal") != VERSION:
        raise UserError(f"{path}: this journal is of another version of greywhale; start anew without --resume.")


def _require_same(path: Path, found: dict[str, Any], wanted: dict[str, Any]) -> None:
    # Compare in the form that JSON gives: tuples become lists there.
    now = json.loads(json.dumps(wanted["request"]))
    then = found["request"]
    # Name a difference in the user's choices first; the others follow from them.
    for key in sorted({*now, *then}, key=lambda name: (name not in _CHOSEN, name)):
        if now.get(key) != then.get(key):
            raise UserError(
                f"{path}: the journal is of another tuning: its {key} is {_short(then.get(key))}, now it is "
                f"{_short(now.get(key))}; give the same again, or start anew without --resume."
            )


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _digest(candidates: Controllers) -> int:
    return zlib.crc32(np.ascontiguousarray(candidates, dtype="<i4").tobytes())
