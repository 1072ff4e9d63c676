"""The whole way at its smallest: work, results file, document, files; and once more from the results."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from greywhale.base.study import choose_workers
from greywhale.cli import entry
from greywhale.cli.verbs import VERBS
from greywhale.reproduce.pages.found import Found
from greywhale.reproduce.pages.report import document
from greywhale.reproduce.request import Request
from greywhale.reproduce.run import run
from tests.reproduce.small import draw_nothing, shrink

LABELS = {f"Table {number}" for number in range(1, 13)} | {f"Fig. {number}" for number in range(1, 21)}


@pytest.fixture
def _small(monkeypatch: pytest.MonkeyPatch) -> None:
    shrink(monkeypatch)


def reproduce(folder: Path, captured: pytest.CaptureFixture[str]) -> dict[str, Any]:
    arguments = ["reproduce", "--quick", "--seeds", "1", "--workers", "1", "--out", str(folder), "--json"]
    assert entry.run(arguments) == 0
    answer = json.loads(captured.readouterr().out)
    assert isinstance(answer, dict)
    return answer


@pytest.mark.slow
@pytest.mark.usefixtures("_small")
def test_every_table_and_figure_is_there_and_stays_the_same(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    answer = reproduce(tmp_path / "one", capsys)
    assert set(answer["entries"]) == LABELS
    open_ones = {label for label, status in answer["entries"].items() if status == "cannot be reproduced"}
    assert open_ones == {"Table 1", "Fig. 1"}
    files = {Path(name).name for name in answer["files"]}
    assert files == {"report.html", "report.pdf", "report.json"}
    report = json.loads((tmp_path / "one" / "report.json").read_text(encoding="utf-8"))
    for chapter in report["chapters"]:
        for one in chapter["entries"]:
            assert one["blocks"], one["title"]
            for block in one["blocks"]:
                assert "nan" not in json.dumps(block).lower().split()
    results = next((tmp_path / "one").glob("*.study"))
    before, request = results.read_bytes(), Request.of(0, 1, quick=True)
    again = Found(request, run(request, tmp_path / "one", choose_workers(1)))  # nothing is left to do
    assert results.read_bytes() == before
    draw_nothing(monkeypatch)
    assert document(again).as_dict()["chapters"] == report["chapters"]


def test_the_verb_refuses_what_makes_no_sense(capsys: pytest.CaptureFixture[str]) -> None:
    assert "reproduce" in VERBS
    assert entry.run(["reproduce", "--seeds", "0"]) == 2
    assert "seeds is 0" in capsys.readouterr().err
