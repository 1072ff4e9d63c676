"""Files are whole, and on the disk with their names, before anybody says that they are written."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.base.formats.whole import write_text
from greywhale.files.leader import save_leader
from greywhale.files.log import LogWriter
from greywhale.files.log.layout import Origin
from greywhale.files.parameter_file import save
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.table import ParameterTable
from greywhale.tune.search.journal import TuningJournal


def write_log(path: Path) -> None:
    with LogWriter(path, Origin()) as log:
        log.append(0.0, [0.0] * 4, [0.0] * 4, [0.0] * 4, "following")


def write_leader(path: Path) -> None:
    save_leader(path, Trajectory(np.array([0.0, 1.0]), np.zeros((2, 4))))


WRITERS = {
    "text": lambda path: write_text(path, "text"),
    "log": write_log,
    "leader": write_leader,
    "parameters": lambda path: save(path, ParameterTable.defaults()),
}


class Disk:
    """Notes in which order files are brought to the disk and get their names."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self.done: list[str] = []
        sync, link, replace = os.fsync, os.link, os.replace

        def note_sync(descriptor: int) -> None:
            mode = os.fstat(descriptor).st_mode
            self.done.append("folder" if stat.S_ISDIR(mode) else f"file of {os.fstat(descriptor).st_size}")
            sync(descriptor)

        def note_link(old: Path, new: Path, *, src_dir_fd: int) -> None:
            link(old, new, src_dir_fd=src_dir_fd)
            self.done.append(f"name {'hidden' if new.name.startswith('.') else new.name}")

        def note_replace(old: Path, new: Path) -> None:
            replace(old, new)
            self.done.append(f"name {new.name}")

        patch.setattr(os, "fsync", note_sync)
        patch.setattr(os, "link", note_link)
        patch.setattr(os, "replace", note_replace)


@pytest.mark.parametrize("write", [WRITERS[name] for name in WRITERS if name != "log"])
def test_the_file_then_its_name_are_on_the_disk(
    write: Callable[[Path], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk = Disk(monkeypatch)
    write(tmp_path / "file")
    whole = f"file of {(tmp_path / 'file').stat().st_size}"
    assert disk.done == [whole, "name file", "folder"]
    disk.done.clear()
    write(tmp_path / "file")
    assert disk.done == [whole, "name hidden", "name file", "folder"]


def test_a_log_is_on_the_disk_before_it_says_that_it_is_complete(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk = Disk(monkeypatch)
    write_log(tmp_path / "log.csv")
    whole = f"file of {(tmp_path / 'log.csv').stat().st_size}"
    assert disk.done == ["name log.unfinished.csv", whole, whole, "name log.csv", "folder"]


def test_a_journal_is_on_the_disk_when_it_is_closed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    disk = Disk(monkeypatch)
    with TuningJournal(tmp_path / "journal", {"seed": 1}) as book:
        assert disk.done == ["folder"]
        book.tell("stage", np.zeros((2, 13), dtype=np.int32), np.ones((2, 4)))
    assert disk.done == ["folder", f"file of {(tmp_path / 'journal').stat().st_size}"]


def test_a_disk_that_fails_is_told_and_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(descriptor: int) -> None:
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(UserError, match="file: cannot be written: input/output error"):
        write_text(tmp_path / "file", "text")
    assert os.listdir(tmp_path) == []


def test_a_file_system_without_such_a_promise_for_folders_will_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sync = os.fsync

    def refuse_folders(descriptor: int) -> None:
        if stat.S_ISDIR(os.fstat(descriptor).st_mode):
            raise OSError(errno.EINVAL, os.strerror(errno.EINVAL))
        sync(descriptor)

    monkeypatch.setattr(os, "fsync", refuse_folders)
    write_text(tmp_path / "file", "text")
    assert (tmp_path / "file").read_text() == "text"
