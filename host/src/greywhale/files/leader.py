"""Leader files: CSV with the columns time_s, leader_0 .. leader_3 (s, rad); a recorded log is one too.

A bad file is refused before anything moves, with one sentence naming file, line, column, value and remedy.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from greywhale.base.errors import UserError
from greywhale.base.formats import csv_file
from greywhale.base.formats.whole import refuse_devices, write_text
from greywhale.base.types import Floats
from greywhale.files.log.check import add_rows, facts_of
from greywhale.files.log.condition import judge_condition
from greywhale.files.log.layout import COLUMNS as LOG_COLUMNS
from greywhale.files.trajectory import POT_RANGE_RAD, Trajectory
from greywhale.protocol.firmware import JOINTS

LONGEST_S = 3600.0
# Far beyond a hand (some 30 rad/s), but a step of `multi_steps` over the whole range, 40 ms long, stays below it.
FASTEST_RAD_S = 250.0

COLUMNS = ("time_s", *(f"leader_{joint}" for joint in range(JOINTS)))


@dataclass(frozen=True)
class _Rows:
    """Times (n,), angles (n, 4) and the lines that they stand on."""

    name: str
    time_s: Floats
    angles: Floats
    lines: npt.NDArray[np.int64]
    remarks: tuple[str, ...]

    def error(self, row: int, column: str, problem: str) -> UserError:
        return UserError(f"{self.name}, line {self.lines[row]}, column {column}: {problem}.")


def load_leader(path: str | Path) -> Trajectory:
    """Read and check a leader file or a log; its first row becomes time 0."""
    rows = _read(path)
    outside = np.argwhere(np.abs(rows.angles) > POT_RANGE_RAD)
    if len(outside):
        row, joint = (int(index) for index in outside[0])
        problem = (
            f"{rows.angles[row, joint]:g} rad is out of the potentiometers' range "
            f"[-{POT_RANGE_RAD}, {POT_RANGE_RAD}] rad; shift or scale this joint"
        )
        raise rows.error(row, COLUMNS[1 + joint], problem)
    _check_pace(rows)
    return Trajectory(rows.time_s - rows.time_s[0], rows.angles, rows.remarks)


def _read(path: str | Path) -> _Rows:
    """The columns of the leader, a block of the file after another."""
    time_s, angles, lines = [np.empty(0)], [np.empty((0, JOINTS))], [np.empty(0, dtype=np.int64)]
    before, crc, is_log = -np.inf, 0, _is_log(path)
    with csv_file.CsvFile(path, LOG_COLUMNS if is_log else COLUMNS) as file:
        for block in file.blocks():
            table = file.table(block)
            time_s.append(table.increasing("time_s", before))
            angles.append(np.column_stack([table.numbers(column) for column in COLUMNS[1:]]))
            lines.append(np.array(table.lines, dtype=np.int64))
            before = float(time_s[-1][-1]) if table.lines else before
            crc = add_rows(crc, block.data)
        times = np.concatenate(time_s)
        file.require_rows(len(times), 2)
        told = judge_condition(file.name, facts_of(file.comments), crc, times).remarks if is_log else ()
    remarks = tuple(f"{file.name}: {remark}" for remark in told)
    return _Rows(file.name, times, np.concatenate(angles), np.concatenate(lines), remarks)


def _check_pace(rows: _Rows) -> None:
    """Refuse what takes too long to play, and speeds that no leader has; these are mostly wrong units."""
    time_s, angles = rows.time_s, rows.angles
    late = np.flatnonzero(time_s - time_s[0] > LONGEST_S)
    if late.size:
        problem = f"{time_s[late[0]]:g} s is more than {LONGEST_S:g} s after the first row; times are in s"
        raise rows.error(int(late[0]), "time_s", problem)
    speed = np.abs(np.diff(angles, axis=0)) / np.diff(time_s)[:, None]
    jumps = np.argwhere(speed > FASTEST_RAD_S)
    if len(jumps):
        row, joint = (int(index) for index in jumps[0])
        problem = (
            f"from {angles[row, joint]:g} to {angles[row + 1, joint]:g} rad in {time_s[row + 1] - time_s[row]:g} s is "
            f"faster than {FASTEST_RAD_S:g} rad/s; give a jump more time"
        )
        raise rows.error(row + 1, COLUMNS[1 + joint], problem)


def save_leader(path: str | Path, trajectory: Trajectory) -> None:
    """Write a leader file; it appears whole or not at all."""
    lines = [",".join(COLUMNS)]
    for time_s, angles in zip(trajectory.time_s, trajectory.angles, strict=True):
        lines.append(f"{time_s:.4f}," + ",".join(f"{angle:.5f}" for angle in angles))
    write_text(path, "\n".join(lines) + "\n")


def _is_log(path: str | Path) -> bool:
    """Whether the column names are a log's. A file that cannot be read counts as none; its reader refuses it."""
    try:
        refuse_devices(path)
        with open(path, encoding="utf-8-sig") as file:
            heading = next((line for line in file if not line.startswith("#")), "")
    except (OSError, UnicodeDecodeError):
        return False
    return [cell.strip() for cell in heading.split(",")] == list(LOG_COLUMNS)
