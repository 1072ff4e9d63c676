"""The check of a log: a line of its header has the number of its rows, and a CRC-32 over them and the facts beside it.

The line is in the header, not below the rows: so a log that was cut still says how many rows it had, and the file below
the header is plain CSV. Ends of lines (CR LF) and comments of people do not count, every other byte of a row does.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterable, Mapping
from enum import StrEnum

from greywhale.base.errors import UserError, cut
from greywhale.files.log.parameters import KEY as PARAMETERS

KEY = "check"
# What the CRC covers beside the rows and the parameters.
_FACTS = {
    "firmware",
    "board",
    "parameter_crc",
    "period_ms",
    "every_ticks",
    "joints_in_use",
    "dropped_samples",
    "recording",
    "gaps",
    "ended_by",
}
_FORM = re.compile(r"([0-9]{1,18}) rows, crc32 [0-9a-f]{8}")


class Check(StrEnum):
    """The outcome of a log's check."""

    WHOLE = "whole"  # as it was recorded
    UNCHECKED = "unchecked"  # it has none: an older log, one of another tool, or one whose program was killed
    SHORTENED = "shortened"  # rows are missing, so nothing is known of the others
    CHANGED = "changed"  # all rows are there or more, but rows or header are others


def facts_of(comments: Iterable[str]) -> dict[str, str]:
    """The facts in the comments of a header."""
    pairs = (comment.partition(":") for comment in comments)
    return {key.strip(): value.strip() for key, colon, value in pairs if colon}


def add_rows(crc: int, lines: bytes) -> int:
    """The CRC of all rows so far, with these whole lines; it begins with 0."""
    return zlib.crc32(lines.replace(b"\r\n", b"\n") if b"\r" in lines else lines, crc)


def check_text(rows: int, crc: int, facts: Mapping[str, str]) -> str:
    """The check that the header of a log with these rows, their CRC and these facts holds."""
    covered = [f"{key}: {facts[key]}\n" for key in sorted(facts) if key in _FACTS or key.startswith(PARAMETERS)]
    return f"{rows} rows, crc32 {zlib.crc32(''.join(covered).encode(), crc):08x}"


def rows_stated(facts: Mapping[str, str], name: str) -> int | None:
    """The number of rows that the check of the log `name` is for; None where it has no check."""
    stated = facts.get(KEY, "")
    form = _FORM.fullmatch(stated)
    if stated and form is None:
        raise UserError(
            f"{name}: check is {cut(repr(stated))} in the header, but it must be such as "
            "'20000 rows, crc32 1a2b3c4d'; take the log as it was recorded, or delete this line."
        )
    return None if form is None else int(form[1])


def compare(facts: Mapping[str, str], name: str, rows: int, crc: int) -> Check:
    """Compare the check of the log `name` with the rows that were read, and their CRC."""
    stated = rows_stated(facts, name)
    if stated is None:
        return Check.UNCHECKED
    if rows < stated:
        return Check.SHORTENED
    return Check.WHOLE if facts[KEY] == check_text(rows, crc, facts) else Check.CHANGED
