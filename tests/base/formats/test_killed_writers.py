"""A writer that is killed at any of its changes leaves the old file or the new one, and the next one cleans up."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.formats.checked_lines import CheckedLines, Kind
from greywhale.base.formats.whole import write_text
from greywhale.files.log import LogWriter, read_log
from greywhale.files.log.layout import Origin
from tests.support.killing import count_changes, kill

OLD, NEW = "old\n", "new\n" * 5000
KIND = Kind("a_diary", 1, "diary", "voyage", "begin another one", "on page two", lambda line: "day" in line, ())
DAYS = [{"day": number} for number in range(4)]
ROW = ([0.1] * 4, [-0.1] * 4, [1.0] * 4, "following")
ROWS = 600  # more than one write


def kill_at_each_change(work: Callable[[Path], object], folder: Path, old: str | None) -> list[Path]:
    """A folder for each change that the work makes to its file, as the kill has left it."""
    whole = folder_with(folder / "whole", old)
    changes = count_changes(lambda: work(whole / "file"))
    left = []
    for change in range(changes):
        place = folder_with(folder / str(change), old)
        kill(lambda place=place: work(place / "file"), change)  # type: ignore[misc]
        left.append(place)
    assert len(left) > 2
    return left


def folder_with(folder: Path, old: str | None) -> Path:
    folder.mkdir()
    if old is not None:
        (folder / "file").write_text(old)
    return folder


@pytest.mark.parametrize("old", [None, OLD])
def test_a_whole_file_is_the_old_or_the_new_one(tmp_path: Path, old: str | None) -> None:
    seen = set()
    for place in kill_at_each_change(lambda path: write_text(path, NEW), tmp_path, old):
        path = place / "file"
        seen.add(path.read_text() if path.exists() else None)
        write_text(path, NEW)
        assert [one.name for one in place.iterdir()] == ["file"], "the next writer sweeps what is hidden"
    assert seen == {old, NEW}


def record(path: Path) -> None:
    with LogWriter(path, Origin("1.2.3", "mega2560", 0xBEEF, 20, 5)) as log:
        for row in range(ROWS):
            log.append(row * 0.005, *ROW)


def test_a_log_is_whole_or_lies_beside_it_unfinished(tmp_path: Path) -> None:
    rows = set()
    for place in kill_at_each_change(record, tmp_path, None):
        if (place / "file").exists():
            assert read_log(place / "file").complete
        for path in place.glob("file.unfinished*"):
            log = read_log(path)
            assert not log.complete or len(log.time) == ROWS, "only its name was missing"
            np.testing.assert_allclose(np.diff(log.time), 0.005)
            rows.add(len(log.time))
    assert len(rows) > 1


def keep_diary(path: Path) -> None:
    with CheckedLines(path, KIND, {}, keep=True) as lines:
        for day in DAYS[len(lines.found) :]:
            lines.append(day)


def test_a_journal_goes_on_behind_its_last_whole_line(tmp_path: Path) -> None:
    for place in kill_at_each_change(keep_diary, tmp_path, None):
        keep_diary(place / "file")
        with CheckedLines(place / "file", KIND, {}, keep=True) as lines:
            assert lines.found == DAYS
