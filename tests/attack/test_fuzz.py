"""The corpora under the sanitizers, a few runs more, and firmware that is broken on purpose."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from tools.attack.parts import fuzz


def test_the_corpora_are_small(tmp_path: Path) -> None:
    for target in fuzz.TARGETS:
        (tmp_path / target).mkdir()
        inputs = fuzz.unpack(target, tmp_path / target)
        assert 10 < len(inputs) <= 300
        assert sum(path.stat().st_size for path in inputs) < 100_000


@pytest.mark.slow
@pytest.mark.parametrize("target", fuzz.TARGETS)
def test_the_corpus_breaks_nothing(target: str) -> None:
    failed, report = fuzz.replay(fuzz.TARGETS[target], target)
    assert not failed, fuzz.reason(report)


@pytest.mark.slow
def test_more_runs_break_nothing() -> None:
    row = fuzz.fuzz(fuzz.TARGETS["table"], "table", 1, 400)
    assert (row.trials, row.violations) == (400, 0)


# For the watcher and for the sanitizers: a file, what stands there, what is put in its place, and what must be said.
BROKEN = {
    "a stop that does nothing": (
        "supervisor/src/supervisor.cpp",
        "if (motors_on()) switch_off(State::disabled, StopReason::host);",
        "",
        "a stop turns the motors off",
    ),
    "a queue that overflows": (
        "app/src/lead.cpp",
        "steps_[(first_ + waiting_) % room]",
        "steps_[first_ + waiting_]",
        "runtime error|AddressSanitizer",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", BROKEN)
def test_broken_firmware_is_found(tmp_path: Path, name: str) -> None:
    file, right, wrong, says = BROKEN[name]
    app = fuzz.TARGETS["app"]
    firmware = tmp_path / "lib"
    shutil.copytree(app.firmware, firmware)
    text = (firmware / file).read_text(encoding="utf-8")
    assert right in text
    (firmware / file).write_text(text.replace(right, wrong), encoding="utf-8")
    failed, report = fuzz.replay(replace(app, name="broken_app", firmware=firmware), "app")
    assert failed
    assert any(sentence in fuzz.reason(report) for sentence in says.split("|")), fuzz.reason(report)
