"""Where a session and a stop meet: the same name for all names of a port, another one for another device."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from types import SimpleNamespace

import pytest

from greywhale.board import meeting


def test_a_device_is_one_under_all_its_names(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to("/dev/null")
    assert meeting.device_of(str(tmp_path / "link")) == meeting.device_of("/dev/null") == "1:3"
    assert meeting.device_of("/dev/zero") == "1:5"


def test_what_is_no_device_has_none(tmp_path: Path) -> None:
    for name in (str(tmp_path), str(tmp_path / "none"), "bench in lock step", "a\0b"):
        assert meeting.device_of(name) is None


def test_a_pseudo_terminal_is_not_the_one_that_had_its_number_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """Else a session that is just ending would keep others from a new bench."""

    def made_at(time: int, major: int) -> str | None:
        found = SimpleNamespace(st_mode=stat.S_IFCHR | 0o620, st_rdev=os.makedev(major, 5), st_ctime_ns=time)
        with monkeypatch.context() as patch:
            patch.setattr(os, "stat", lambda name: found)
            return meeting.device_of("/dev/x")

    assert made_at(1, 136) != made_at(2, 136)
    assert made_at(1, 166) == made_at(2, 166), "but the owner of a real port may change while it is in use"


def test_the_names_are_the_users_own(monkeypatch: pytest.MonkeyPatch) -> None:
    ours = meeting.names_of("1:3")
    assert len(set(ours)) == meeting.NAMES
    monkeypatch.setattr(os, "geteuid", lambda: 4711)
    assert not set(ours) & set(meeting.names_of("1:3"))
