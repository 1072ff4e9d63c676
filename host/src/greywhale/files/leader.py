"""Leader files: CSV with the columns time_s, leader_0 .. leader_3 (s, rad); a recorded log is one too.

A bad file is refused before anything moves, with one sentence naming file, line, column, value and remedy.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from greywhale.base.errors import UserError
from greywhale.base.formats import csv_file
from greywhale.base.formats.whole import write_text
from greywhale.base.types import Floats
from greywhale.files.log.check import add_rows, facts_of
from greywhale.files.log.condition import judge_condition
from greywhale.files.log.layout import COLUMNS as LOG_COLUMNS
from greywhale.files.log.limits import LEADER
from greywhale.files.log.reader import refuse_other_times
from greywhale.files.log.units import doubt_speed, perhaps_degrees
from greywhale.files.trajectory import POT_RANGE_RAD, Trajectory
from greywhale.protocol.firmware import JOINTS

COLUMNS = ("time_s", *(f"leader_{joint}" for joint in range(JOINTS)))


def load_leader(path: str | Path) -> Trajectory:
    """Read and check a leader file or a log, a block after another; its first row becomes time 0."""
    each_time, each_angle, lines = [np.empty(0)], [np.empty((0, JOINTS))], [np.empty(0, dtype=np.int64)]
    before, crc = -np.inf, 0
    with csv_file.CsvFile(path, COLUMNS, LOG_COLUMNS) as file:
        for block in file.blocks():
            table = file.table(block)
            each_time.append(table.increasing("time_s", before))
            each_angle.append(np.column_stack([table.numbers(column) for column in COLUMNS[1:]]))
            lines.append(np.array(table.lines, dtype=np.int64))
            before = float(each_time[-1][-1]) if table.lines else before
            crc = add_rows(crc, block.data)
        time_s, angles = np.concatenate(each_time), np.concatenate(each_angle)
        file.require_rows(len(time_s), 2)
        facts = facts_of(file.comments) if file.columns is LOG_COLUMNS else {}
        refuse_other_times(file.name, facts, time_s)
        remarks = () if "every_ticks" in facts else doubt_speed(time_s, angles)
        if file.columns is LOG_COLUMNS:
            remarks += judge_condition(file.name, facts, crc, time_s).remarks
    wrong = _find_wrong(time_s, angles)
    if wrong is not None:
        row, column, problem = wrong
        raise UserError(f"{file.name}, line {np.concatenate(lines)[row]}, column {column}: {problem}.")
    return Trajectory(time_s - time_s[0], angles, tuple(f"{file.name}: {remark}" for remark in remarks))


def _find_wrong(time_s: Floats, angles: Floats) -> tuple[int, str, str] | None:
    """Row, column and problem of what no leader has: angles out of range, a motion that takes too long to play, and
    speeds that mostly are wrong units.
    """
    for row, joint in np.argwhere(np.abs(angles) > POT_RANGE_RAD)[:1].tolist():
        perhaps = perhaps_degrees(float(np.abs(angles).max())) or "; shift or scale this joint"
        allowed = f"[-{POT_RANGE_RAD}, {POT_RANGE_RAD}] rad{perhaps}"
        problem = f"{angles[row, joint]:g} rad is out of the potentiometers' range {allowed}"
        return row, COLUMNS[1 + joint], problem
    for row in np.flatnonzero(time_s - time_s[0] > LEADER.longest_s)[:1].tolist():
        late = f"{time_s[row]:g} s is more than {LEADER.longest_s:g} s after the first row; times are in s"
        return row, "time_s", late
    speed = np.abs(np.diff(angles, axis=0)) / np.diff(time_s)[:, None]
    for row, joint in np.argwhere(speed > LEADER.fastest_rad_s)[:1].tolist():
        move = f"{angles[row, joint]:g} to {angles[row + 1, joint]:g} rad in {time_s[row + 1] - time_s[row]:g} s"
        problem = f"from {move} is faster than {LEADER.fastest_rad_s:g} rad/s; give a jump more time, and times in s"
        return row + 1, COLUMNS[1 + joint], problem
    return None


def save_leader(path: str | Path, trajectory: Trajectory) -> None:
    """Write a leader file; it appears whole or not at all."""
    lines = [",".join(COLUMNS)]
    for time_s, angles in zip(trajectory.time_s, trajectory.angles, strict=True):
        lines.append(f"{time_s:.4f}," + ",".join(f"{angle:.5f}" for angle in angles))
    write_text(path, "\n".join(lines) + "\n")
