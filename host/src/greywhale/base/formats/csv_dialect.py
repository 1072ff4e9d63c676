"""The forms in which spreadsheets save a CSV file: other separators, decimal commas, quotes, commas behind comments."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence

SEPARATORS = (",", ";", "\t", "|")
# A line such as `sep=;` with which some spreadsheets begin a file.
_SEPARATOR_LINE = re.compile(r"\s*\"?sep=.\"?\s*", re.IGNORECASE)
_COMMENT = re.compile(rb'(?mi)^[ \t]*"?(#|sep=)[^\n]*\n')
_BEHIND = "".join(SEPARATORS) + " \r\n"


def comment_in(line: str) -> str | None:
    """A comment's text without `#`, quotes and the empty cells that a spreadsheet put behind it; else None."""
    text = line.strip()
    if _SEPARATOR_LINE.fullmatch(text):
        return ""
    if text.startswith('"#'):
        behind = re.sub(r'^"([^"]|"")*"', "", text)
        separator = behind[0] if behind[:1] in SEPARATORS and behind else ","
        try:
            text = separator.join(next(csv.reader([text], delimiter=separator), []))
        except csv.Error:  # a monstrous cell: what reads the column names refuses it
            return None
    return text.rstrip(_BEHIND)[1:].strip() if text.startswith("#") else None


def without_comments(data: bytes) -> Iterator[tuple[int, int, bytes]]:
    """The lines between those that are comments: number of lines and of bytes before them, and the lines."""
    if b"#" not in data and b"=" not in data:  # as in most files
        yield 0, 0, data
        return
    lines = begin = 0
    for comment in (*_COMMENT.finditer(data), None):
        part = data[begin : comment.start() if comment else len(data)]
        if part:
            yield lines, begin, part
        if comment:
            lines, begin = lines + part.count(b"\n") + 1, comment.end()


def cells_of(line: str, separator: str = ",", least: int = 0) -> list[str]:
    """The cells of a line without blanks around them; empty ones at its end are left out, but for the first `least`.

    csv.Error where it is no CSV.
    """
    cells = [cell.strip() for cell in next(csv.reader([line], delimiter=separator, strict=True), [])]
    while len(cells) > least and not cells[-1]:
        cells.pop()
    return cells


def separator_of(heading: str, names: Sequence[str]) -> str:
    """The separator by which a line has most of these column names; a comma where none is better."""
    return max(SEPARATORS, key=lambda one: len({cell.strip(' "') for cell in heading.split(one)} & set(names)))


def to_commas(data: bytes, separator: str) -> bytes:
    """Lines with another separator and perhaps decimal commas, as lines with commas and decimal points."""
    return data if separator == "," else data.translate(bytes.maketrans(separator.encode() + b",", b",."))
