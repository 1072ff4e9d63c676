"""Leader files: CSV with the columns time_s, leader_0 .. leader_3 (s, rad); a recorded log is one too.

A bad file is refused before anything moves, with one sentence naming file, line, column, value and remedy.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from greywhale.files.log.layout import COLUMNS as LOG_COLUMNS
from greywhale.firmware import JOINTS
from greywhale.formats import csv_file
from greywhale.formats.whole import refuse_devices, write_text
from greywhale.trajectory.motion import POT_RANGE_RAD, Array, Trajectory

LONGEST_S = 3600.0
# Far beyond a hand (some 30 rad/s), but a step of `multi_steps` over the whole range, 40 ms long, stays below it.
FASTEST_RAD_S = 250.0

COLUMNS = ("time_s", *(f"leader_{joint}" for joint in range(JOINTS)))


def load_leader(path: str | Path) -> Trajectory:
    """Read and check a leader file or a log; its first row becomes time 0."""
    table = csv_file.read(path, LOG_COLUMNS if _is_log(path) else COLUMNS, minimum_rows=2)
    time_s = table.increasing("time_s")
    angles = np.column_stack([table.numbers(column) for column in COLUMNS[1:]])
    outside = np.argwhere(np.abs(angles) > POT_RANGE_RAD)
    if len(outside):
        row, joint = (int(index) for index in outside[0])
        problem = (
            f"{angles[row, joint]:g} rad is out of the potentiometers' range [-{POT_RANGE_RAD}, {POT_RANGE_RAD}] rad; "
            "shift or scale this joint"
        )
        raise table.error(row, COLUMNS[1 + joint], problem)
    _check_pace(table, time_s, angles)
    return Trajectory(time_s - time_s[0], angles)


def _check_pace(table: csv_file.CsvTable, time_s: Array, angles: Array) -> None:
    """Refuse what takes too long to play, and speeds that no leader has; these are mostly wrong units."""
    late = np.flatnonzero(time_s - time_s[0] > LONGEST_S)
    if late.size:
        problem = f"{time_s[late[0]]:g} s is more than {LONGEST_S:g} s after the first row; times are in s"
        raise table.error(int(late[0]), "time_s", problem)
    speed = np.abs(np.diff(angles, axis=0)) / np.diff(time_s)[:, None]
    jumps = np.argwhere(speed > FASTEST_RAD_S)
    if len(jumps):
        row, joint = (int(index) for index in jumps[0])
        problem = (
            f"from {angles[row, joint]:g} to {angles[row + 1, joint]:g} rad in {time_s[row + 1] - time_s[row]:g} s is "
            f"faster than {FASTEST_RAD_S:g} rad/s; give a jump more time"
        )
        raise table.error(row + 1, COLUMNS[1 + joint], problem)


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
