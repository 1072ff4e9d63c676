"""Writes a log so that the named file is always whole: it gets its name when it is closed.

Whatever ends the recording, also an error or Ctrl-C, the samples received so far are kept and the header says
`interrupted`. Of a recording that is killed what was received stays in log.unfinished.csv beside log.csv, or in
log.unfinished-2.csv where that is taken; its header says `unfinished`. Only when nothing was recorded is no file left.
Dropped samples are counted, never filled in. The check over all rows grows with them, and stands in the header of a
finished log.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

from greywhale.base.errors import UserError, cut, os_reason
from greywhale.base.formats.draft import Draft, sync
from greywhale.files.log.check import KEY, add_rows, check_text, facts_of
from greywhale.files.log.episodes import KEY as TASK
from greywhale.files.log.episodes import task_line
from greywhale.files.log.layout import (
    COMPLETE,
    HEADING,
    INTERRUPTED,
    QUANTITIES,
    STATES,
    TIME_DIGITS,
    TITLE,
    UNFINISHED,
    Origin,
)
from greywhale.protocol.firmware import JOINTS

_DIGITS = (TIME_DIGITS, *(digits for digits in QUANTITIES.values() for _ in range(JOINTS)))
_ROW = ",".join(f"%.{digits}f" for digits in _DIGITS) + ",%s\n"
# What is known only at the end: the header keeps so many characters free for each number or word, and for the reason.
_VALUE_ROOM = 12
_REASON_ROOM = 320


class LogWriter:
    """Use as a context manager; `rows` and `dropped` count the rows written and the samples that the link lost.

    Where the port may go away in between, `gaps` keeps room for them in the header.
    """

    def __init__(self, path: str | Path, origin: Origin, *, gaps: bool = False) -> None:
        self.path = Path(path)
        self.origin = origin
        self.rows = 0
        self.dropped = 0
        self.gaps: list[tuple[float, float]] = []  # s: when each began, and its length
        self._states_gaps = gaps
        self._last_us: int | None = None
        self._shown = False
        self._unwritten = b""
        self._size = 0  # of the file, in whole lines
        self._kept, self._crc = 0, 0  # rows in the file, and their CRC

    def __enter__(self) -> Self:
        try:
            self._draft = Draft(self.path, buffering=0)
        except OSError as error:
            raise self._cannot_be_written(error) from None
        self._file = self._draft.file
        self._waiting = [self._header(UNFINISHED, "").decode("ascii"), HEADING + "\n"]
        try:
            self.flush()
        except UserError:
            self._draft.discard()
            raise
        self._kept, self._crc = 0, 0
        return self

    def append(
        self,
        time_s: float,
        leader: Sequence[float],
        follower: Sequence[float],
        voltage: Sequence[float],
        state: str,
    ) -> None:
        """Add one sample: s, rad, rad, V."""
        numbers = (time_s, *leader, *follower, *voltage)
        if len(numbers) != 13 or state not in STATES:
            raise ValueError(
                f"a sample has 13 numbers and one of the states {STATES}, not {len(numbers)} and {state!r}"
            )
        if not all(map(math.isfinite, numbers)):
            raise ValueError(f"samples are finite numbers, not {numbers}")
        time_us = round(time_s * 1e6)
        if self._last_us is not None and time_us <= self._last_us:
            raise ValueError(f"time must increase by whole microseconds, but {time_us} us follows {self._last_us} us")
        self._last_us = time_us
        self.rows += 1
        self._waiting.append(_ROW % (time_us / 1e6, *numbers[1:], state))
        if len(self._waiting) >= 256:  # a quarter of a second at most
            self.flush()

    def flush(self) -> None:
        """Write what waits. If the disk takes only a part of it, the whole lines stay. From the first rows on a kill
        leaves what was written.
        """
        self._settle()  # Ctrl-C may have come between a write and this
        lines = "".join(self._waiting).encode("ascii")
        self._unwritten, self._waiting = self._unwritten + lines, []
        done = 0
        try:
            while done < len(self._unwritten):
                done += self._file.write(self._unwritten[done:])
        except OSError as error:
            raise self._cannot_be_written(error) from None
        finally:
            self._settle()
        if self.rows and not self._shown:
            self._shown = True
            try:
                self._draft.show_as(self.path.with_name(f"{self.path.stem}.{UNFINISHED}{self.path.suffix}"))
            except OSError as error:
                raise self._cannot_be_written(error) from None

    def _settle(self) -> None:
        """Keep what the file took of a write, in whole lines, and add it to the check."""
        taken = self._unwritten[: self._file.seek(0, os.SEEK_END) - self._size]
        lines = taken[: taken.rfind(b"\n") + 1]
        if len(lines) < len(taken):
            self._file.truncate(self._size + len(lines))
        size, kept, crc = self._size + len(lines), self._kept + lines.count(b"\n"), add_rows(self._crc, lines)
        # Without a call in between, so that Ctrl-C finds all of them or none.
        self._size, self._kept, self._crc, self._unwritten = size, kept, crc, self._unwritten[len(lines) :]

    @property
    def last_s(self) -> float:
        """The time of the last row, 0 before the first."""
        return (self._last_us or 0) / 1e6

    def gap(self, length_s: float) -> None:
        """State that nothing could be received for so long, after the last row."""
        self.gaps.append((round(self.last_s, 3), round(length_s, 3)))
        self.drop(round(1000 * length_s / (self.origin.every_ticks or 1)))

    def drop(self, samples: int) -> None:
        """Count samples that the board sent, or should have sent, and that never arrived."""
        self.dropped += samples

    def __exit__(
        self, kind: type[BaseException] | None, raised: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.rows == 0:
            self._draft.discard()
            return
        problem: UserError | None = None
        try:
            self.flush()
        except UserError as full:
            problem = full
        try:
            sync(self._file)  # before anything says that it is there
            self._file.seek(0)
            complete = kind is None and problem is None
            reason = "" if complete else _reason(raised or problem)
            self._file.write(self._header(COMPLETE if complete else INTERRUPTED, reason, checked=True))
            self._draft.keep()
            if isinstance(raised, KeyboardInterrupt | UserError):
                raised.add_note(f"What was recorded is in {self.path}, marked as interrupted.")
        except OSError as error:
            self._draft.discard()
            unkept = self._cannot_be_written(error)
            if self._draft.path is not None:
                unkept.add_note(f"What was recorded is in {self._draft.path}.")
            raise unkept from None
        if problem is not None and kind is None:
            raise problem

    def _cannot_be_written(self, error: OSError) -> UserError:
        return UserError(f"{self.path}: cannot be written: {os_reason(error)}.")

    def _header(self, ending: str, reason: str, *, checked: bool = False) -> bytes:
        """The header. Its length is always the same, so that the end of a recording can rewrite it in place."""
        facts = self.origin.facts.items()
        lines = [f"# {TITLE}", *(f"# {task_line(value) if key == TASK else f'{key}: {value}'}" for key, value in facts)]
        lines += [f"# dropped_samples: {self.dropped:<{_VALUE_ROOM}d}", f"# recording: {ending:<{_VALUE_ROOM}}"]
        if self._states_gaps:
            lines.append(f"# gaps: {cut(_gaps(self.gaps), _REASON_ROOM):<{_REASON_ROOM}}")
        lines.append(f"# ended_by: {cut(reason, _REASON_ROOM):<{_REASON_ROOM}}")
        text = "\n".join(lines).encode("ascii", "replace").decode("ascii")
        check = check_text(self._kept, self._crc, facts_of(line[1:] for line in text.split("\n"))) if checked else ""
        return f"{text}\n# {KEY}: {check:<40}\n".encode("ascii")


def _gaps(gaps: Sequence[tuple[float, float]]) -> str:
    """The gaps in words, the first ones one by one."""
    each = ", ".join(f"{length:g} s after {begin:g} s" for begin, length in gaps)
    return f"{len(gaps)}: {each}" if gaps else "none"


def _reason(raised: BaseException | None) -> str:
    """The reason why a recording ended early, in one line."""
    notes = getattr(raised, "__notes__", ())
    if isinstance(raised, UserError):
        return raised.message.replace("\n", " ")
    if isinstance(raised, KeyboardInterrupt):
        return notes[0] if notes else "Ctrl-C, or a signal to end."
    return type(raised).__name__
