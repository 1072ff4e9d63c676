"""A page lists the files that its verbs take, and no others."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.cli.catalogue import catalogue
from greywhale.dashboard.folder import Folder
from greywhale.dashboard.verbs import command_line

MOTION = "time_s,leader_0,leader_1,leader_2,leader_3\n"
TAKEN = ["a motion.csv", "a=b.csv", "--help.csv", "é 字.csv", "sub/a.csv", "sub/e=f.csv", "way/a.csv"]
# A name that turns the letters after it around, breaks lines, is no text, or leads elsewhere.
REFUSED = ["log\u202efdp.csv", "a\nb.csv", "a\x1b[2J.csv", os.fsdecode(b"\xff.csv"), "out.csv", "loop.csv", "b=/c.csv"]


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    inside = tmp_path / "folder"
    for name in ("sub", "b="):
        (inside / name).mkdir(parents=True)
    (inside / "way").symlink_to("sub")
    (inside / "loop.csv").symlink_to("loop.csv")
    (tmp_path / "out.csv").write_text(MOTION)
    (inside / "out.csv").symlink_to(tmp_path / "out.csv")
    for name in {*TAKEN, *REFUSED} - {"out.csv", "loop.csv", "way/a.csv"}:
        (inside / name).write_text(MOTION)
    return Folder(inside)


def test_what_is_listed_can_be_chosen_and_what_cannot_be_is_not_listed(folder: Folder) -> None:
    evaluate = next(one for one in catalogue() if one["verb"] == "evaluate")
    listed = [one["name"] for one in folder.files()]
    assert sorted(listed) == sorted([*TAKEN, "way/e=f.csv"])
    json.dumps(listed, ensure_ascii=False).encode()
    for name in listed:
        assert folder.file(name).is_file()
        assert name in command_line(evaluate, {"logs": [name]}, folder)
    for name in REFUSED:
        with pytest.raises(UserError):
            command_line(evaluate, {"logs": [name]}, folder)
