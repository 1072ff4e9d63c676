"""Rows of a log as the writer writes them, parsed all at once: digits with a fixed number of decimals.

A row in any other form, and one that is wrong, is none of these; whoever asks then goes through the cells one by one.
Numbers come out exactly as `float` reads them: a whole number of up to 15 digits over a power of ten is rounded once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from greywhale.files.log.layout import COLUMNS, STATES

NUMBERS = len(COLUMNS) - 1
# As the writer writes them.
DECIMALS = tuple(3 if name.startswith("voltage") else 6 for name in COLUMNS[:-1])
_MOST_DIGITS = 6  # before the point
_COMMA, _NEWLINE, _MINUS, _POINT, _ZERO = (ord(one) for one in ",\n-.0")

Bytes = NDArray[np.uint8]
Places = NDArray[np.int64]


def parse_rows(data: bytes) -> tuple[NDArray[np.float64], NDArray[np.int8]] | None:
    """Numbers (rows, 13) and states (rows,) as places in STATES, of whole lines; None where one has another form."""
    text = np.frombuffer(data, dtype=np.uint8)
    newlines = np.flatnonzero(text == _NEWLINE)
    all_commas = np.flatnonzero(text == _COMMA)
    if len(all_commas) != NUMBERS * len(newlines):
        return None
    commas = all_commas.reshape(len(newlines), NUMBERS)
    first = np.concatenate(([0], newlines[:-1] + 1))
    if (commas[:, 0] < first).any() or (commas[:, -1] > newlines).any():
        return None
    starts = np.column_stack([first, commas[:, :-1] + 1])
    numbers = np.empty((len(newlines), NUMBERS))
    for column, decimals in enumerate(DECIMALS):
        values = _fixed_point(text, starts[:, column], commas[:, column], decimals)
        if values is None:
            return None
        numbers[:, column] = values
    states = _words(text, commas[:, -1] + 1, newlines)
    return None if states is None else (numbers, states)


def _fixed_point(text: Bytes, start: Places, end: Places, decimals: int) -> NDArray[np.float64] | None:
    """Numbers such as -0.123456, each with so many decimals."""
    negative = text[start] == _MINUS
    point = end - 1 - decimals
    whole = point - start - negative  # digits before the point
    if whole.size and (whole.min() < 1 or whole.max() > _MOST_DIGITS):
        return None
    if (text[point] != _POINT).any():
        return None
    value = np.zeros(len(start), dtype=np.int64)
    for place in range(int(whole.max(initial=0)), 0, -1):
        # A shorter number has something else here, and counts as 0.
        digit = np.where(place <= whole, text[np.maximum(point - place, 0)] - np.uint8(_ZERO), np.uint8(0))
        if (digit > 9).any():
            return None
        value = 10 * value + digit
    for place in range(1, decimals + 1):
        digit = text[point + place] - np.uint8(_ZERO)
        if (digit > 9).any():
            return None
        value = 10 * value + digit
    size = value / 10.0**decimals
    return np.where(negative, -size, size)


def _words(text: Bytes, start: Places, end: Places) -> NDArray[np.int8] | None:
    """The states' places in STATES."""
    lengths = end - start
    states = np.full(len(start), -1, dtype=np.int8)
    for number, word in enumerate(STATES):
        rows = np.flatnonzero(lengths == len(word))
        letters = text[start[rows, None] + np.arange(len(word))]
        states[rows[(letters == np.frombuffer(word.encode(), dtype=np.uint8)).all(axis=1)]] = number
    return None if (states < 0).any() else states
