"""A file that is being written has no name, or one that the next writer in its folder removes when its writer died."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import signal
import stat
from collections.abc import Callable
from pathlib import Path

import pytest

from greywhale.base.formats.draft import Draft, sweep
from greywhale.base.formats.whole import write_text


def need_names(patch: pytest.MonkeyPatch) -> None:
    """Know no files without a name."""
    open_ = os.open

    def refuse(path: Path, flags: int, *rest: int) -> int:
        if flags & os.O_TMPFILE == os.O_TMPFILE:
            raise OSError(errno.EOPNOTSUPP, os.strerror(errno.EOPNOTSUPP), str(path))
        return open_(path, flags, *rest)

    patch.setattr(os, "open", refuse)


@pytest.fixture(params=["without a name", "with a hidden name", "without locks"])
def file_system(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """File systems, from able to unable."""
    if request.param != "without a name":
        need_names(monkeypatch)
    if request.param == "without locks":

        def fail(descriptor: int, operation: int) -> None:
            raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

        monkeypatch.setattr(fcntl, "flock", fail)
    return str(request.param)


def hidden(folder: Path) -> list[str]:
    return [name for name in os.listdir(folder) if name.startswith(".")]


def die_while(work: Callable[[], None]) -> None:
    """Do this in a process that then is killed."""
    child = os.fork()
    if child == 0:
        with contextlib.suppress(BaseException):
            work()
        os.kill(os.getpid(), signal.SIGKILL)
    os.waitpid(child, 0)


@pytest.mark.usefixtures("file_system")
def test_a_file_appears_and_is_replaced_whole(tmp_path: Path) -> None:
    for text in ("one", "another"):
        write_text(tmp_path / "file", text)
        assert (tmp_path / "file").read_text() == text
        assert os.listdir(tmp_path) == ["file"]


@pytest.mark.usefixtures("file_system")
def test_a_file_has_the_rights_that_the_user_gives(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write_text(tmp_path / "file", "text")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "file").stat().st_mode) == 0o640


@pytest.mark.usefixtures("file_system")
def test_what_fails_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("old")
    work = Draft(tmp_path / "file")
    work.file.write(b"new")
    work.discard()
    assert (tmp_path / "file").read_text() == "old"
    assert os.listdir(tmp_path) == ["file"]


def test_a_killed_writer_leaves_nothing_where_files_need_no_name(tmp_path: Path) -> None:
    die_while(lambda: Draft(tmp_path / "file").file.flush())
    assert os.listdir(tmp_path) == []


def test_the_next_writer_removes_what_a_killed_one_left(tmp_path: Path, file_system: str) -> None:
    """Killed between the two names of a file that replaces another, or with a name from the beginning."""
    (tmp_path / "file").write_text("old")

    def write_and_die() -> None:
        setattr(os, "replace", lambda old, new: os.kill(os.getpid(), signal.SIGKILL))  # noqa: B010
        write_text(tmp_path / "file", "new")

    die_while(write_and_die)
    assert len(hidden(tmp_path)) == 1
    assert (tmp_path / "file").read_text() == "old"
    write_text(tmp_path / "other", "text")
    # Without locks nobody can tell whether the writer lives.
    assert len(hidden(tmp_path)) == (1 if file_system == "without locks" else 0)


@pytest.mark.usefixtures("file_system")
def test_a_writer_that_lives_is_left_alone(tmp_path: Path) -> None:
    slow = Draft(tmp_path / "slow")
    slow.file.write(b"slow")
    write_text(tmp_path / "quick", "quick")
    slow.keep()
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"slow": "slow", "quick": "quick"}


def test_a_writer_that_was_swept_before_it_had_its_lock_begins_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    need_names(monkeypatch)
    flock = fcntl.flock
    swept: list[str] = []

    def sweep_first(descriptor: int, operation: int) -> None:
        if operation == fcntl.LOCK_EX and not swept:
            swept.extend(hidden(tmp_path))
            sweep(tmp_path)
        flock(descriptor, operation)

    monkeypatch.setattr(fcntl, "flock", sweep_first)
    write_text(tmp_path / "file", "text")
    assert len(swept) == 1
    assert os.listdir(tmp_path) == ["file"]


def test_only_drafts_are_swept(tmp_path: Path) -> None:
    names = [".greywhale-notes.new", ".log.csv.x.part", ".greywhale-0123456789abcdef.new.old"]
    for name in names:
        (tmp_path / name).touch()
    os.mkdir(tmp_path / ".greywhale-0123456789abcdef.new")
    write_text(tmp_path / "file", "text")
    assert sorted(os.listdir(tmp_path)) == sorted([*names, ".greywhale-0123456789abcdef.new", "file"])


def test_a_visible_name_is_never_taken_from_another(tmp_path: Path) -> None:
    (tmp_path / "log.unfinished.csv").write_text("precious")
    work = Draft(tmp_path / "log.csv")
    assert work.show_as(tmp_path / "log.unfinished.csv").name == "log.unfinished-2.csv"
    work.keep()
    assert (tmp_path / "log.unfinished.csv").read_text() == "precious"
    assert sorted(os.listdir(tmp_path)) == ["log.csv", "log.unfinished.csv"]
