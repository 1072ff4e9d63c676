"""The whole way at its smallest: work, results file, document, files; and once more from the results."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from greywhale.cli import entry
from greywhale.cli.verbs import VERBS
from greywhale.reproduce.work import errata, findings, on_the_bench, optimisers
from greywhale.reproduce.work.motions import MOTIONS
from greywhale.trajectory import multi_steps, steps
from tools.docs.schemas import read_answer, validate

LABELS = {f"Table {number}" for number in range(1, 13)} | {f"Fig. {number}" for number in range(1, 21)}
METHODS = ("gwo-woa", "gwo", "woa", "pso")


def as_paper(seed: int, seconds: float, period_ms: int, budget: int | None, traces: bool) -> dict[str, Any]:
    """In the place of greywhale's own tuning, which takes a hundred times as long."""
    assert budget is not None
    return on_the_bench.follow_as_paper(seed, seconds, period_ms, traces)


@pytest.fixture
def _small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(on_the_bench, "follow_as_default", as_paper)
    monkeypatch.setattr(optimisers, "METHODS", METHODS)
    for name in ("pages.optimisers", "pages.findings"):
        monkeypatch.setattr(f"greywhale.reproduce.{name}.METHODS", METHODS)
    monkeypatch.setattr(optimisers, "functions", lambda: ("sphere",))
    monkeypatch.setattr(errata, "cases", lambda: {"E14": ("E14",), "E1 to E8": ("E2",)})
    monkeypatch.setattr(errata, "HOLD_S", 0.2)
    monkeypatch.setattr(errata, "SWING_S", 0.1)
    monkeypatch.setattr(findings, "PERIODS_MS", (1, 20))
    monkeypatch.setitem(MOTIONS, "steps", lambda: steps(1.0, 0.8, 1.8))
    monkeypatch.setitem(MOTIONS, "multi-steps", lambda: multi_steps([0.0, 1.0, -0.5], [0.8, 1.2, 1.8]))
    monkeypatch.setattr("greywhale.reproduce.request.Request.logged_s", 5.0)
    monkeypatch.setattr("greywhale.reproduce.request.Request.function_runs", 4)


def reproduce(folder: Path, captured: pytest.CaptureFixture[str]) -> dict[str, Any]:
    arguments = ["reproduce", "--quick", "--seeds", "1", "--workers", "1", "--out", str(folder), "--json"]
    assert entry.run(arguments) == 0
    answer = read_answer(captured.readouterr().out)
    validate("reproduce", answer)
    assert isinstance(answer, dict)
    return answer


@pytest.mark.slow
@pytest.mark.usefixtures("_small")
def test_every_table_and_figure_is_there_and_stays_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
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
    before = results.read_bytes(), [(tmp_path / "one" / name).read_bytes() for name in sorted(files)]
    reproduce(tmp_path / "one", capsys)  # goes on from what is done: nothing is left to do
    assert (results.read_bytes(), [(tmp_path / "one" / name).read_bytes() for name in sorted(files)]) == before


def test_the_verb_refuses_what_makes_no_sense(capsys: pytest.CaptureFixture[str]) -> None:
    assert "reproduce" in VERBS
    for wrong, words in ((["--seeds", "0"], "seeds is 0"), (["--executor", "here"], "there is no executor")):
        assert entry.run(["reproduce", *wrong]) == 2
        assert words in capsys.readouterr().err
