"""The corpora under the sanitizers, a few runs more, and firmware that is broken on purpose."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from tools.campaign.parts import fuzz


def test_pieces_have_every_target_at_any_share() -> None:
    assert {piece["target"] for piece in fuzz.pieces(1e-9)} == set(fuzz.TARGETS) == set(fuzz.TITLES)


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
    row = fuzz.fuzz(fuzz.TARGETS["app"], "app", 1, 400)
    assert (row.trials, row.violations) == (400, 0)


# A file, what stands there, what is put in its place, and what the watcher must say.
BROKEN = {
    "a stop that does nothing": (
        "supervisor/src/supervisor.cpp",
        "if (motors_on()) switch_off(State::disabled, StopReason::host);",
        "",
        "a stop turns the motors off",
    ),
    "a lease that never ends": (
        "supervisor/src/supervisor.cpp",
        "if (lease_ && --lease_ == 0)",
        "if (lease_ && lease_-- == 0)",
        "the motors are off when the lease has run out",
    ),
    "an emergency stop that is not seen": (
        "supervisor/src/supervisor.cpp",
        "if (seen.estop) raise_always(Fault::estop);",
        "",
        "the motors are off while the emergency stop is pressed",
    ),
    "a broken wire that is not seen": (
        "supervisor/src/supervisor.cpp",
        "rails_.fill(seen.rail_low, seen.rail_high)",
        "rails_.leak(0)",
        "the motors are off in the third tick in a row",
    ),
    "a late tick that does not count": (
        "supervisor/src/supervisor.cpp",
        "if (seen.late) return raise(Fault::late_tick, nowhere);",
        "static_cast<void>(seen);",
        "off after a late tick|no tick starts the motors|tells whether the motors are on",
    ),
    "an apply without its CRC": (
        "app/src/parameter_sets.cpp",
        "if (apply_crc_ != wanted) return end(Progress::crc_differs);",
        "static_cast<void>(wanted);",
        "with the CRC that was given",
    ),
    "a refused set that leaves something behind": (
        "app/src/parameter_sets.cpp",
        "controllers.take(sets_.running(), at_++);",
        "++at_;",
        "the voltage is that of the law|memory that nobody has changed",
    ),
    "a safe set that is none": (
        "app/src/parameter_sets.cpp",
        "params::make_safe(table.joint[i], i);",
        "static_cast<void>(i);",
        "the voltage is that of the law|the one that was applied last",
    ),
    "a reference that jumps": (
        "app/src/lead.cpp",
        "32768L * q12_per_step / 512",
        "32768L * q12_per_step / 256",
        "the host's reference does not jump",
    ),
    "a queue that overflows": (
        "app/src/lead.cpp",
        "steps_[(first_ + waiting_) % room]",
        "steps_[first_ + waiting_]",
        "runtime error|AddressSanitizer",
    ),
    "a memory watch that cries wolf": (
        "app/src/app.cpp",
        "memory_.learn();",
        "",
        "memory that nobody has changed",
    ),
    "a controller that is not reset": (
        "app/src/app.cpp",
        "controllers_.reset();",
        "",
        "the voltage is that of the law|no voltage",
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
