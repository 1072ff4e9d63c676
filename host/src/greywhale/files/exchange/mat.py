"""A log as a MAT-file of version 5, with the names that identification in MATLAB and Octave gives them: y, u, t, Ts."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterable
from pathlib import Path
from typing import IO, Any

import numpy as np

from greywhale.base.errors import UserError
from greywhale.base.formats.whole import write_whole
from greywhale.files.exchange.recording import ExportOptions, Recording
from greywhale.files.log.held import Numbers
from greywhale.files.log.layout import STATES
from greywhale.protocol.firmware import JOINTS, TICK_S

# What a log's quantities are called in system identification: outputs and inputs. Others keep their names.
NAMES = {"follower": "y", "voltage": "u"}
# Of the format: kinds of elements and of arrays, and how many bytes the parts before a matrix's numbers take.
_DOUBLE, _INT8, _INT32, _UINT32, _MATRIX, _CLASS_DOUBLE = 9, 1, 5, 6, 14, 6


def write(recordings: Iterable[Recording], out: Path, options: ExportOptions) -> list[Path]:
    """Write one recording: numbers by the samples' rows, `state` as places in `states`, which count from 1."""
    from scipy import io

    (one,) = recordings
    log = one.log
    columns = {NAMES.get(quantity.name, quantity.name): quantity.values for quantity in one.quantities}
    if log.time.size * JOINTS * log.time.itemsize >= 1 << 31:  # a matrix of version 5 has fewer
        raise UserError(
            f"{log.name}: {log.time.size} rows are more than a MAT-file of version 5 takes; use --to parquet or npz."
        )
    small: dict[str, Any] = {
        "Ts": TICK_S * log.origin.every_ticks if log.origin.every_ticks else float(np.median(np.diff(log.time))),
        "state": (log.places + 1)[:, None],
        "states": np.array(STATES, dtype=object),
        "names": np.array(list(columns), dtype=object),
        "units": np.array([quantity.unit for quantity in one.quantities], dtype=object),
        "facts": json.dumps(log.facts),
    }

    def fill(file: IO[bytes]) -> None:
        io.savemat(file, small, format="5")
        # scipy makes a copy of a matrix before it writes it, for which an hour of samples leaves no room.
        for name, values in {"t": log.time[:, None], **columns}.items():
            _add_matrix(file, name, values)

    write_whole(out, fill)
    return [out]


def _add_matrix(file: IO[bytes], name: str, values: Numbers) -> None:
    """Append a variable (rows, columns) to a MAT-file, one column after another."""
    rows, columns = values.shape
    label = name.encode("ascii")
    size = 8 * rows * columns
    head = struct.pack("<IIII", _UINT32, 8, _CLASS_DOUBLE, 0) + struct.pack("<IIii", _INT32, 8, rows, columns)
    head += struct.pack("<II", _INT8, len(label)) + label + bytes(-len(label) % 8)
    file.write(struct.pack("<II", _MATRIX, len(head) + 8 + size) + head + struct.pack("<II", _DOUBLE, size))
    for column in range(columns):
        file.write(np.ascontiguousarray(values[:, column], dtype="<f8").data)
