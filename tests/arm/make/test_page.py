"""docs/your-arm.md: its example is an answers file, and what the page shows is what the verb prints."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from greywhale.cli.entry import run
from tools import ROOT

PAGE = (ROOT / "docs" / "your-arm.md").read_text(encoding="utf-8")


def block(after: str, language: str = "") -> str:
    """The first code block of a language after these words."""
    found = re.search(rf"```{language}\n(.*?)```", PAGE[PAGE.index(after) :], re.DOTALL)
    assert found is not None
    return found.group(1)


def test_the_example_prints_what_the_page_shows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("answers.toml").write_text(block("The same from a file", "toml"), encoding="utf-8")
    assert run(["arm", "new", "--answers", "answers.toml"]) == 0
    assert capsys.readouterr().out == block("`greywhale arm new --answers answers.toml` prints")
