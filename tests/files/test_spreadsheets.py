"""Logs and motions that a spreadsheet saved again, or a person wrote into: read alike, or refused with the cause."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.files.leader import load_leader, save_leader
from greywhale.files.log import LogWriter, read_log
from greywhale.files.log.check import Check
from greywhale.files.log.layout import Origin
from greywhale.loop import human_reaches

ROWS = 60


def padded(line: str, separator: str = ",") -> str:
    """As a spreadsheet saves it: all lines have as many cells as the longest."""
    return line + separator * (14 - 1 - line.count(separator)) if line.startswith("#") else line


def excel(text: str) -> str:
    return "".join(f"{padded(line)}\r\n" for line in text.splitlines())


def german(text: str) -> str:
    lines = ["sep=;"]
    for line in text.splitlines():
        cells = line if line.startswith("#") else line.replace(",", ";").replace(".", ",")
        lines.append(padded(cells, ";"))
    return "\r\n".join(lines) + "\r\n"


def tabs(text: str) -> str:
    return "".join(line if line.startswith("#") else line.replace(",", "\t") for line in text.splitlines(keepends=True))


def quoted(text: str) -> str:
    lines = [[line] if line.startswith("#") else line.split(",") for line in text.splitlines()]
    return "".join(",".join(f'"{cell}"' for cell in cells) + "\n" for cells in lines)


def wide(text: str) -> str:
    return "".join(f"{line},,\n" for line in text.splitlines()) + ",,,\n,,,\n"


def commented(text: str) -> str:
    lines = text.splitlines(keepends=True)
    return "".join([*lines[:-9], "# here I pushed the arm\n", *lines[-9:-5], '"# and here",,\n', *lines[-5:], "# end"])


# What changes no byte of a row that counts keeps the check of a log.
SAME = (excel, german, tabs, commented)
OTHER = (quoted, wide)


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    path = tmp_path / "log.csv"
    with LogWriter(path, Origin("1.2.3", "mega2560", 0xBEEF, 1, 1)) as log:
        for row in range(ROWS):
            angles = [0.1 * np.sin(0.1 * row + joint) for joint in range(4)]
            log.append(row / 1000, angles, angles[::-1], [row / 7] * 4, "following")
    return path


@pytest.mark.parametrize("save", [*SAME, *OTHER])
def test_a_log_is_the_same(recorded: Path, tmp_path: Path, save: Callable[[str], str]) -> None:
    path = tmp_path / "saved.csv"
    path.write_bytes(save(recorded.read_text()).encode())
    for read in (read_log, load_leader):
        before, after = vars(read(recorded)), vars(read(path))
        for key in before.keys() - {"name", "condition", "remarks"}:
            assert np.array_equal(after[key], before[key]), key
    assert read_log(path).condition.check is (Check.WHOLE if save in SAME else Check.CHANGED)


@pytest.mark.parametrize("save", [*SAME, *OTHER])
def test_a_motion_is_the_same(tmp_path: Path, save: Callable[[str], str]) -> None:
    path = tmp_path / "motion.csv"
    save_leader(path, human_reaches(seed=3, duration_s=2.0))
    before = load_leader(path)
    path.write_bytes(save("# mine\n" + path.read_text()).encode())
    after = load_leader(path)
    assert np.array_equal(before.time_s, after.time_s)
    assert np.array_equal(before.angles, after.angles)


@pytest.mark.parametrize("save", [str, excel, german, tabs])
def test_joined_logs_are_named(recorded: Path, tmp_path: Path, save: Callable[[str], str]) -> None:
    path, text = tmp_path / "joined.csv", save(recorded.read_text())
    path.write_bytes((text + text).encode())
    lines = text.splitlines()
    again = len(lines) + next(number for number, line in enumerate(lines, 1) if line.startswith("time_s"))
    for read in (read_log, load_leader):
        with pytest.raises(UserError, match=f"line {again}: the column names stand here again"):
            read(path)
