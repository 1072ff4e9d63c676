"""What a tuned controller.toml says of itself."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from greywhale.files import controller
from greywhale.tune.report.controller_file import provenance, save
from greywhale.tune.result import TuningResult


def test_a_measure_that_not_every_joint_has_is_left_out(outcome: TuningResult) -> None:
    first, second = provenance(outcome)["expected"]
    assert (first["motion"], second["motion"]) == ("steps", "reaches")
    assert first["mse_after_rad2"] == [0.002468] * 4
    assert first["time_delay_before_s"] == [0.05] * 4
    assert not any(key.startswith(("steady", "onset")) for key in first)


def test_comments_tell_people_what_to_expect(outcome: TuningResult, tmp_path: Path) -> None:
    save(outcome, tmp_path / "controller.toml")
    lines = (tmp_path / "controller.toml").read_text(encoding="utf-8").splitlines()
    assert "# For a control period of 1 ms and a supply of 15 V." in lines
    assert "# Expected on steps, all joints: MSE 0.04 -> 0.00987 rad², 1.23 x the floor." in lines
    # Where nothing saturates a multiple of the floor means nothing.
    assert "# Expected on reaches, all joints: MSE 0.04 -> 0.00987 rad²." in lines
    assert "# Doubt: it was not validated on a second log." in lines
    assert "[[joint]]  # 1: shoulder pitch; on steps MSE 0.01 -> 0.00247 rad², 1.23 x the floor" in lines
    assert not any("UNFINISHED" in line or "NOT STEADY" in line for line in lines)


def test_what_is_unfinished_or_not_steady_says_so_on_top(outcome: TuningResult, tmp_path: Path) -> None:
    swinging = replace(outcome.margins[0], reversals=9, plants_failing=1)
    save(replace(outcome, complete=False, margins=(swinging, *outcome.margins[1:])), tmp_path / "controller.toml")
    text = (tmp_path / "controller.toml").read_text(encoding="utf-8")
    assert (
        text.index("# UNFINISHED: interrupted")
        < text.index("# NOT STEADY: joint 1 (shoulder pitch), at rest.")
        < text.index("[[jo")
    )
    tuning = controller.load(tmp_path / "controller.toml").tuning
    assert tuning is not None
    assert (tuning["status"], tuning["margins_hold"]) == ("unfinished: interrupted; the best so far", False)
    assert tuning["margin"][0]["holds"] == [True, False, True, True]
