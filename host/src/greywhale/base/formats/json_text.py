"""JSON that this program wrote earlier: read strictly, and checked, because disks and people change files."""

from __future__ import annotations

import json
import math
import zlib
from typing import Any

_TAIL = len(',"check":"00000000"}')


def loads(text: str | bytes) -> Any:
    """Parse JSON; a ValueError for what is none, is nested too deeply, or holds a number that is not finite."""
    try:
        return json.loads(text, parse_constant=_finite, parse_float=_finite)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{text} is not a finite number")
    return number


def checked_line(value: dict[str, Any], before: int) -> tuple[bytes, int]:
    """An object as one line that ends with its check, and that check; `before` is the check of the line before.

    So a line that is changed, missing, doubled or out of its place is found.
    """
    body = json.dumps(value, separators=(",", ":"), allow_nan=False).encode()
    check = zlib.crc32(body, before)
    return body[:-1] + f',"check":"{check:08x}"}}\n'.encode(), check


def check_of(line: bytes, before: int) -> int | None:
    """The check of a line that stands after one with the check `before`; None where the line is damaged."""
    line = line.rstrip(b"\n")
    check = zlib.crc32(line[:-_TAIL] + b"}", before)
    return check if line.endswith(f',"check":"{check:08x}"}}'.encode()) else None
