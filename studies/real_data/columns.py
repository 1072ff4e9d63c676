"""Reads named columns of a foreign CSV file."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from greywhale.base.errors import FAILED, UserError, os_reason
from greywhale.base.types import Floats

Columns = dict[str, Floats]


def read_columns(path: Path, needed: Sequence[str]) -> Columns:
    """All columns by name; UserError in one sentence where the file cannot be read or a needed column is missing."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
    except OSError as error:
        raise UserError(f"{path} cannot be read: {os_reason(error)}.", FAILED) from error
    names = rows[0] if rows else []
    missing = [name for name in needed if name not in names]
    if missing:
        raise UserError(f"{path} has no column {missing[0]}; it has {', '.join(names) or 'none'}.", FAILED)
    try:
        values = np.array([[float(field) for field in row] for row in rows[1:]])
    except ValueError as error:
        raise UserError(f"{path} holds something that is no number: {error}.", FAILED) from error
    if values.ndim != 2 or values.shape[1] != len(names):
        raise UserError(f"{path} has rows of another length than its {len(names)} column names.", FAILED)
    return {name: np.ascontiguousarray(values[:, n]) for n, name in enumerate(names)}
