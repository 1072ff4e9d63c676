"""A tuning as text: what people must not overlook is there."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from greywhale.files.controller import load
from greywhale.tune.judge.following import Worse
from greywhale.tune.judge.margins import TEETH
from greywhale.tune.report.controller_file import save
from greywhale.tune.report.summary import summary
from greywhale.tune.result import TuningResult
from tests.tune.models import evaluation


def test_it_shows_before_and_after_and_the_multiple_of_the_floor(outcome: TuningResult) -> None:
    lines = summary(outcome).splitlines()
    assert lines[0].endswith("at 1 ms and 15 V: default, strategy both, seed 3, 10 evaluations.")
    row = next(line for line in lines if line.startswith("1 shoulder pitch"))
    assert row.split()[3:] == ["1.0e-02", "->", "2.5e-03", "1.23", "0.012", "->", "0.012", "0.050", "->", "0.050"]
    assert [line.split()[-3:] for line in lines if line.startswith("all joints")] == [["75.3", "%", "lower"]] * 2
    # Where nothing saturates there is no multiple, and joint 3 never rests.
    assert [line.split()[6] for line in lines if line.startswith("3 wrist roll")] == ["1.23", "-"]
    assert "none -> none" in lines[8]
    assert "WORSE" not in summary(outcome)
    assert "Margins hold on all 2 plants, no joint swings, rattles or chatters: at rest." in lines
    assert lines[-5:] == [
        "Notes:",
        "- a note",
        "",
        "Doubts about the model:",
        "- it was not validated on a second log.",
    ]


def test_what_is_worse_than_before_says_so(outcome: TuningResult) -> None:
    motion = replace(outcome.held_out[0], after=evaluation(0.0103))
    lines = summary(replace(outcome, held_out=(motion,))).splitlines()
    assert [line.endswith(" WORSE") for line in lines if line[:1].isdigit()] == [True] * 4
    assert "all joints" in lines[9]
    assert lines[9].endswith("3.0 % HIGHER")


def test_steps_have_overshoot_and_settling_time_and_more_overshoot_than_before_says_so(
    outcome: TuningResult, tmp_path: Path
) -> None:
    calm, brisk = (
        replace(whole, joints=tuple(replace(joint, overshoot_percent=over, settling_s=0.5) for joint in whole.joints))
        for whole, over in ((evaluation(0.02), 4.0), (evaluation(0.01), 31.4))
    )
    never = replace(brisk.joints[2], overshoot_percent=2.0, settling_s=None, unsettled_steps=1)
    motion = replace(outcome.held_out[0], before=calm, after=replace(brisk, joints=(*brisk.joints[:2], never, never)))
    worse = replace(outcome, held_out=(motion,))
    lines = summary(worse).splitlines()
    table = [line.split() for line in lines if line.startswith(("0 base yaw", "2 wrist pitch"))][2:]
    assert table == [
        ["0", "base", "yaw", "4.0", "->", "31.4", "0.50", "->", "0.50"],
        ["2", "wrist", "pitch", "4.0", "->", "2.0", "0.50", "->", "never"],
    ]
    assert max(len(line) for line in lines if line[:1].isdigit()) <= 80
    said = "MORE OVERSHOOT than before: on steps joint 0 from 4 to 31 %, joint 1 from 4 to 31 %."
    assert said in lines
    save(worse, tmp_path / "controller.toml")
    assert f"# {said}" in (tmp_path / "controller.toml").read_text(encoding="utf-8").splitlines()
    assert "OVERSHOOT" not in summary(outcome)


def test_a_joint_that_follows_worse_is_named_in_text_and_file(outcome: TuningResult, tmp_path: Path) -> None:
    worse = replace(outcome, worse=(Worse(3, "steps", 3.94), Worse(3, "slow following", 1.2)))
    said = (
        "FOLLOWS WORSE than before, by the model: joint 3 (wrist roll) on steps, 3.9 times the error; "
        "joint 3 (wrist roll) on slow following, 1.2 times the error."
    )
    assert said in summary(worse).splitlines()
    save(worse, tmp_path / "controller.toml")
    tuning = load(tmp_path / "controller.toml").tuning
    assert tuning is not None
    assert tuning["follows_worse"] == [one.words for one in worse.worse]
    assert f"# {said}" in (tmp_path / "controller.toml").read_text(encoding="utf-8").splitlines()
    assert "FOLLOWS WORSE" not in summary(outcome)


def test_what_does_not_come_to_rest_is_named(outcome: TuningResult) -> None:
    swinging = replace(outcome.margins[0], reversals=9, chatter_hz=12.3, plants_failing=1)
    text = summary(replace(outcome, margins=(swinging, *outcome.margins[1:])))
    assert "\nNOT STEADY: joint 1 (shoulder pitch), at rest.\n" in text
    assert "Margins hold" not in text
    assert "Margins that" not in text
    delayed = replace(swinging, scenario="one period more delay")
    text = summary(replace(outcome, margins=(*outcome.margins, delayed)))
    assert "\nMargins that do not hold: joint 1 (shoulder pitch), one period more delay.\n" in text
    assert "NOT STEADY" not in text


def test_what_was_no_better_before_speaks_for_neither(outcome: TuningResult, tmp_path: Path) -> None:
    both = tuple(replace(margin, scenario="one period more delay", plants_failing=1) for margin in outcome.margins[:1])
    as_before = replace(outcome, margins_before=both, margins=both)
    text = summary(as_before)
    assert "\nMargins that did not hold before either: joint 1 (shoulder pitch), one period more delay.\n" in text
    assert "Margins that do not" not in text
    assert as_before.steady
    assert not replace(as_before, margins=(replace(both[0], plants_failing=2),)).steady
    assert replace(as_before, margins=(replace(both[0], scenario=TEETH),)).steady, "that is no condition"
    hunting = (replace(both[0], scenario="at rest"),)
    still_hunting = replace(outcome, margins_before=hunting, margins=hunting)
    assert "\nNOT STEADY: joint 1 (shoulder pitch), at rest.\n" in summary(still_hunting), "an arm that hunts, hunts"
    assert not still_hunting.steady


def test_an_unfinished_one_was_not_judged(outcome: TuningResult) -> None:
    text = summary(replace(outcome, complete=False, margins=(), held_out=()))
    assert text.startswith("UNFINISHED: interrupted; this is the best so far.\n")
    assert "Expected" not in text
    assert "argins" not in text
