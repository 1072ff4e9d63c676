"""Outputs that could not be written are refused in one sentence, and checking leaves nothing behind."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.base.errors import BAD_USAGE, UserError
from greywhale.files.outputs import require_files, require_folder


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("kept")
    (tmp_path / "there").mkdir()
    return tmp_path


def sentence_of(error: pytest.ExceptionInfo[UserError]) -> str:
    assert error.value.exit_code == BAD_USAGE
    return error.value.message


@pytest.mark.parametrize(
    ("path", "sentence"),
    [
        ("none/log.csv", "none/log.csv: the folder none does not exist; create it, or write elsewhere."),
        ("file/log.csv", "file/log.csv: file is not a folder; name one, or write elsewhere."),
        ("there", "there: this is a folder; name a file in it."),
        ("-", "-: a result goes into a file, never to standard output; name one (./- is a file named -)."),
        ("/dev/null", "/dev/null: cannot be written: not an ordinary file; write elsewhere."),
        ("/proc/log.csv", "/proc/log.csv: cannot be written: no such file or directory; write elsewhere."),
    ],
)
def test_files_that_cannot_be_written(folder: Path, path: str, sentence: str) -> None:
    with pytest.raises(UserError) as refused:
        require_files(Path("good.csv"), None, Path(path))
    assert sentence_of(refused) == sentence
    assert sorted(one.name for one in folder.iterdir()) == ["file", "there"]


def test_files_that_can_be_written_stay_as_they_are(folder: Path) -> None:
    require_files(Path("file"), Path("new"), Path("there/new"), None)
    assert (folder / "file").read_text() == "kept"
    assert sorted(str(one.relative_to(folder)) for one in folder.rglob("*")) == ["file", "there"]


@pytest.mark.parametrize(
    ("path", "sentence"),
    [
        ("file", "file: pictures go into a folder, and this is a file."),
        ("file/deep/er", "file/deep/er: {folder}/file is not a folder; write elsewhere."),
        ("/proc/none/pictures", "/proc/none/pictures: cannot be made: no such file or directory; write elsewhere."),
        ("/proc", "/proc/new: cannot be written: no such file or directory; write elsewhere."),
        ("there", "there/taken.png: this is a folder; name a file in it."),
    ],
)
def test_folders_that_will_not_do(folder: Path, path: str, sentence: str) -> None:
    (folder / "there" / "taken.png").mkdir()
    with pytest.raises(UserError) as refused:
        require_folder(Path(path), "pictures", "taken.png")
    assert sentence_of(refused) == sentence.format(folder=folder)


def test_folder_that_can_be_made_is_not_made_yet(folder: Path) -> None:
    require_folder(Path("there"), "pictures", "sets.png")
    require_folder(Path("new/deep"), "pictures")
    require_folder(None, "pictures")
    assert sorted(str(one.relative_to(folder)) for one in folder.rglob("*")) == ["file", "there"]
