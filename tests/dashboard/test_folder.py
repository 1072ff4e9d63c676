"""A page lists, brings, renames and deletes the files that its verbs take, and no others."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.cli.catalogue import catalogue
from greywhale.dashboard.folder import IF_THERE, Folder, IfThere, spool
from greywhale.dashboard.verbs import command_line
from greywhale.files.log.layout import HEADING, TITLE

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


LOG = f"# {TITLE}\n{HEADING}\n".encode()
NO_NAMES = [
    *(
        "../a.csv",
        "/etc/a.csv",
        "a/../a.csv",
        "way/new.csv",
        "out.csv",
        "loop.csv",
        "",
        ".",
        "..",
        "a\0.csv",
        "a\n.csv",
    ),
    *(".a.csv", ".git/a.csv", "none/a.csv", "sub", "x" * 300 + ".csv", "a.txt", "a.CSV", "log\u202efdp.csv"),
]


def receive(folder: Folder, name: str, content: bytes, if_there: IfThere = "refuse") -> str:
    with spool() as pieces:
        pieces.write(content)
        return folder.receive(name, pieces, if_there)


def content_of(folder: Folder) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder.path.parent)): path.read_bytes()
        for path in sorted(folder.path.parent.rglob("*"))
        if path.is_file()
    }


def test_a_file_comes_whole_and_over_another_only_where_that_is_asked_for(folder: Folder) -> None:
    assert receive(folder, "sub/new.csv", LOG) == "sub/new.csv"
    assert (folder.path / "sub/new.csv").read_bytes() == LOG
    with pytest.raises(UserError, match="sub/new.csv: exists already"):
        receive(folder, "sub/new.csv", LOG + b"1")
    assert receive(folder, "sub/new.csv", LOG + b"2", "rename") == "sub/new-2.csv"
    assert receive(folder, "sub/new.csv", LOG + b"3", "replace") == "sub/new.csv"
    told = {one["name"]: one for one in folder.files()}
    assert [told[name]["size_bytes"] for name in ("sub/new.csv", "sub/new-2.csv")] == [len(LOG) + 1] * 2
    os.utime(folder.path / "sub/new.csv", (1e9, 1.5e9))
    assert next(one["changed_s"] for one in folder.files() if one["name"] == "sub/new.csv") == 1.5e9


def test_a_file_gets_another_name_and_goes(folder: Folder) -> None:
    folder.rename("a=b.csv", "sub/é.csv")
    for new in ("sub/a.csv", "b.toml"):
        with pytest.raises(UserError, match="exists already|must end with .csv"):
            folder.rename("sub/é.csv", new)
    folder.remove("sub/é.csv")
    assert [one["name"] for one in folder.files() if "b.csv" in one["name"] or "é.csv" in one["name"]] == []


@pytest.mark.parametrize("name", NO_NAMES)
def test_no_name_leads_a_change_out_of_the_folder_or_to_what_no_verb_takes(folder: Folder, name: str) -> None:
    (folder.path / "a.txt").write_text("mine")
    (folder.path / "notes.toml").write_text("mine = 1")
    before = content_of(folder)
    changes: list[Callable[[], object]] = [
        *(partial(receive, folder, name, LOG, if_there) for if_there in IF_THERE),
        partial(folder.rename, "a=b.csv", name),
        partial(folder.rename, name, "free.csv"),
        *(partial(change, name) for change in (folder.remove, folder.own)),
        partial(folder.remove, "notes.toml"),
        partial(receive, folder, "notes.toml", b"[[joint]]\nkp = 1", "replace"),
    ]
    for change in changes:
        with pytest.raises(UserError):
            change()
    assert content_of(folder) == before


@pytest.mark.parametrize(
    ("name", "content"),
    [("a.toml", b"# no table"), ("b.toml", b"\xff"), ("c.csv", b"a,b\n"), ("d.hex", b"MZ"), ("e.toml", b"a=[" * 9000)],
)
def test_what_no_verb_takes_is_not_taken_from_a_page(folder: Folder, name: str, content: bytes) -> None:
    with pytest.raises(UserError, match=rf"{name}: it is no file that a verb takes: a log"):
        receive(folder, name, content)
    assert not (folder.path / name).exists()
