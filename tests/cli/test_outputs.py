"""No verb writes over a file that it reads."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.cli.entry import run

Captured = pytest.CaptureFixture[str]


@pytest.mark.parametrize(
    "arguments",
    [
        ("identify", "one", "--out", "one"),
        ("identify", "other", "--validate", "one", "--out", "./one"),
        ("identify", "other", "--arm", "one", "--out", "one"),
        ("identify", "other", "--controller", "one", "--out", "one"),
        ("replay", "one", "--out", "one"),
        ("evaluate", "one", "--picture", "one"),
        ("export", "--urdf", "one", "--out", "one"),
        ("export", "--mjcf", "one", "--out", "one"),
        ("export", "--fis", "one", "--joint", "0", "--out", "one"),
        ("record", "--excite", "--arm", "one", "--out", "one"),
        ("record", "--excite", "--arm", "one", "--save-motion", "one"),
        ("tune", "one", "--out", "one"),
    ],
)
def test_a_file_that_is_read_is_never_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured, arguments: tuple[str, ...]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("one").write_text((Path(__file__).parents[2] / "shared/fuzzy_tables/table_10.toml").read_text())
    Path("other").write_text("nothing")
    before = Path("one").read_bytes()
    assert run(list(arguments)) == 2
    assert capsys.readouterr().err.strip() == "greywhale: one: this file is read from; write elsewhere."
    assert Path("one").read_bytes() == before


def test_log_and_motion_are_two_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["record", "--excite", "--out", "a.csv", "--save-motion", "./a.csv"]) == 2
    assert "the log and the motion cannot be one file" in capsys.readouterr().err
