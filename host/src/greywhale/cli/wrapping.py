"""Fits text to a terminal: what is longer than its lines is broken between words. A pipe gets it whole, for grep."""

from __future__ import annotations

import os
import re
from typing import TextIO

from greywhale.base.telling import LINE_COLUMNS

# A word with the gap before it. A `command` is one word with its spaces, so that it can be copied.
_WORD = re.compile(r"(\s*)((?:`[^`]*`|\S)+)")
_PLAIN_WORD = re.compile(r"(\s*)(\S+)")


def fit(text: str, stream: TextIO, hang: int = 0) -> str:
    """Text for a stream; what is broken off a line stands below it, `hang` columns to the right."""
    width = columns(stream)
    return text if width is None else wrap(text, width, hang)


def columns(stream: TextIO) -> int | None:
    """The width of a terminal in columns; None for a pipe or a file."""
    if not stream.isatty():
        return None
    try:
        return os.get_terminal_size(stream.fileno()).columns or LINE_COLUMNS
    except (OSError, ValueError):
        return LINE_COLUMNS


def wrap(text: str, width: int, hang: int = 0) -> str:
    """Break lines longer than `width`; those that fit, such as a table's, stay as they are."""
    return "\n".join("\n".join(_broken(line, width, hang)) for line in text.split("\n"))


def _broken(line: str, width: int, hang: int) -> list[str]:
    if len(line) <= width:
        return [line]
    most = min(width, 120)  # longer lines are hard to read
    indent = " " * max(hang, len(line) - len(line.lstrip()))
    done, now = [], ""
    for gap, word in _words(line, most - len(indent)):
        if now.strip() and len(now) + len(gap) + len(word) > most:
            done.append(now)
            gap, now = indent, ""
        now += gap + word
    return [*done, now]


def _words(line: str, most: int) -> list[tuple[str, str]]:
    """Each word with its gap; a `command` that fits no line is broken too."""
    found: list[tuple[str, str]] = []
    for gap, word in _WORD.findall(line):
        found += [(gap, word)] if len(word) <= most else _PLAIN_WORD.findall(gap + word)
    return found
