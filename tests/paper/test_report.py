"""What a request asks for; and the whole way at its smallest: work, results file, document, files; and once more."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.base.study import choose_workers
from greywhale.cli import entry
from greywhale_paper.pages.found import Found
from greywhale_paper.pages.report import document
from greywhale_paper.request import Request
from greywhale_paper.run import results_file, run
from greywhale_paper.tasks import tasks_of
from tests.paper.small import draw_nothing, shrink

LABELS = {f"Table {number}" for number in range(1, 13)} | {f"Fig. {number}" for number in range(1, 21)}


@pytest.mark.slow
def test_every_table_and_figure_is_there_and_stays_the_same(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    shrink(monkeypatch)
    arguments = ["reproduce", "--quick", "--seeds", "1", "--workers", "1", "--out", str(tmp_path), "--json"]
    assert entry.run(arguments) == 0
    answer = json.loads(capsys.readouterr().out)
    assert set(answer["entries"]) == LABELS
    open_ones = {label for label, status in answer["entries"].items() if status == "cannot be reproduced"}
    assert open_ones == {"Table 1", "Fig. 1"}
    files = {Path(name).name for name in answer["files"]}
    assert files == {"report.html", "report.pdf", "report.json"}
    report = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    for chapter in report["chapters"]:
        for one in chapter["entries"]:
            assert one["blocks"], one["title"]
            for block in one["blocks"]:
                assert "nan" not in json.dumps(block).lower().split()
    results = next(tmp_path.glob("*.study"))
    before, request = results.read_bytes(), Request.of(0, 1, quick=True)
    again = Found(request, run(request, tmp_path, choose_workers(1)))  # nothing is left to do
    assert results.read_bytes() == before
    draw_nothing(monkeypatch)
    assert document(again).as_dict()["chapters"] == report["chapters"]


def test_a_quick_request_asks_for_the_same_kinds_of_work() -> None:
    def kinds(quick: bool) -> set[str]:
        return {task.function.__qualname__ for task in tasks_of(Request.of(0, None, quick))}

    assert kinds(True) == kinds(False)
    assert len(tasks_of(Request.of(0, None, True))) < len(tasks_of(Request.of(0, None, False)))


def test_seeds_count_from_the_first() -> None:
    request = Request.of(7, 4, False)
    assert request.every_seed == (7, 8, 9, 10)
    assert request.few_seeds == (7, 8, 9)


def test_another_request_has_another_results_file() -> None:
    folder = Path("out")
    files = {results_file(Request.of(seed, 3, quick), folder) for seed in (0, 1) for quick in (False, True)}
    assert len(files) == 4


@pytest.mark.parametrize(("seed", "seeds"), [(-1, 3), (0, 0), (0, 1001)])
def test_what_makes_no_sense_is_refused(seed: int, seeds: int) -> None:
    with pytest.raises(UserError, match="it must be"):
        Request.of(seed, seeds, True)
