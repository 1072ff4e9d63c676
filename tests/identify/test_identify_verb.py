"""`greywhale identify` as a person or a program calls it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from greywhale.cli import identify as verb
from greywhale.cli.entry import run
from greywhale.files.arm import load_arm
from greywhale.identify import IdentificationResult
from greywhale.pictures import page
from tools.support.recordings import TABLES, Recorded


def arguments(recorded: Recorded, folder: Path) -> list[str]:
    logs = [recorded.fit.name, "-v", recorded.second.name, "-v", recorded.changed.name]
    controllers = ["-c", str(TABLES / "before_tuning.toml"), "-c", str(TABLES / "table_10.toml")]
    return ["identify", *logs, *controllers, "--out", str(folder / "model.toml")]


@pytest.mark.slow
def test_text_model_and_pictures(
    outcome: IdentificationResult,
    recorded: Recorded,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(verb, "identify", lambda *logs, **options: outcome)
    monkeypatch.setattr(page, "DPI", 100)
    assert run([*arguments(recorded, tmp_path), "--pictures", str(tmp_path / "pictures")]) == 0
    text = capsys.readouterr().out
    for word in ("white box", "all joints", "changed controller", "joint0.damping", "Fisher", "model.toml"):
        assert word in text
    load_arm(tmp_path / "model.toml")
    pictures = sorted(path.name for path in (tmp_path / "pictures").iterdir())
    assert pictures == ["responses_1.png", "responses_2.png", "responses_3.png"]
    assert all(path.stat().st_size > 20_000 for path in (tmp_path / "pictures").iterdir())


@pytest.mark.slow
def test_interrupt_writes_the_model_and_says_so(
    outcome: IdentificationResult,
    recorded: Recorded,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    unfinished = replace(outcome, found=replace(outcome.found, complete=False))
    monkeypatch.setattr(verb, "identify", lambda *logs, **options: unfinished)
    assert run(arguments(recorded, tmp_path)) == 130
    assert "marked as unfinished" in capsys.readouterr().err
    model = load_arm(tmp_path / "model.toml")
    assert model.identification is not None
    assert model.identification["status"].startswith("unfinished")
    assert model.name.endswith("(unfinished)")
