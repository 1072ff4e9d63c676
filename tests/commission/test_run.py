"""A whole commissioning: never worse than before, at any exit the controllers from before, and it goes on from any."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.base.errors import UserError
from greywhale.commission import CommissioningRequest, commission, learn, run
from greywhale.commission.limits import COMMISSIONING_LIMITS, CommissioningLimits
from greywhale.commission.page import facts, save_page
from greywhale.commission.result import CommissioningResult, errors_beside
from greywhale.commission.search import CheckOnModel
from greywhale.files.arm import default_arm, load_arm
from greywhale.files.leader import load_leader
from greywhale.files.log import Log, read_log
from greywhale.files.model import arm_toml
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.table import ParameterTable
from tests.commission.simulated import KP, in_no_time, options_in
from tests.support.arms import make_arm
from tests.support.limits import copy_of, reads_of
from tests.tune.models import write_model
from tools.support.simulated_rig import SimulatedRig

pytestmark = pytest.mark.slow
Make = Callable[..., CommissioningRequest]


@pytest.fixture(autouse=True)
def _in_no_time(rig: SimulatedRig, monkeypatch: pytest.MonkeyPatch) -> None:
    in_no_time(rig, monkeypatch)


@dataclass(frozen=True)
class Whole:
    """A commissioning that came to its end, to read."""

    rig: SimulatedRig
    options: Make
    outcome: CommissioningResult


def ending(**other: Any) -> CommissioningLimits:
    """The usual limits, but for some of those at which a round ends."""
    return replace(COMMISSIONING_LIMITS, rounds=replace(COMMISSIONING_LIMITS.rounds, **other))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Whole:
    rig, options = SimulatedRig(default_arm()), options_in(tmp_path_factory.mktemp("whole"))
    with pytest.MonkeyPatch.context() as patch:
        in_no_time(rig, patch)
        return Whole(rig, options, commission(options()))


def test_the_board_ends_with_what_passed_on_the_arm(whole: Whole) -> None:
    rig, outcome = whole.rig, whole.outcome
    assert outcome.best.passes_at_a_price
    assert np.array_equal(controllers_of(rig.stored), outcome.best.rows)
    assert [verdict.score < 0.5 for verdict in outcome.best.verdicts][:3] == [True] * 3
    assert outcome.improved
    before = outcome.trials.table
    assert rig.played[0] == before, "the little first motion is made with the controllers from before"


def test_interrupted_anywhere_the_board_keeps_what_it_had_and_resuming_ends_the_same(
    rig: SimulatedRig, options: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At the first motion, at the check before, at a trial of the round, and at the confirmation."""
    monkeypatch.setattr(
        CommissioningResult, "predicted", lambda outcome, trial, round_: trial.measured
    )  # what follows from trials
    whole = commission(options(trials=2))
    told, plays, before = whole.as_dict(), len(rig.played), whole.trials.table
    assert plays == 5, "the first motion, the check before, two trials, and the confirmation"
    for stop in (0, 1, 2, 4):
        rig.stored = rig.before = before
        rig.played.clear()

        def interrupt(number: int, stop: int = stop) -> None:
            if number == stop:
                raise KeyboardInterrupt

        rig.at_play = interrupt
        out = options().out.parent / f"stopped-{stop}"
        with pytest.raises(KeyboardInterrupt):
            commission(options(out=out, trials=2))
        assert rig.stored == before
        rig.at_play = lambda number: None
        again = commission(options(out=out, trials=2, resume=stop > 0))
        assert again.as_dict() == told
        assert len(rig.played) == plays, "no motion is made twice"


def test_a_round_ends_where_more_trials_are_not_worth_their_time(
    rig: SimulatedRig, options: Make, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    steps: list[tuple[str, str]] = []
    outcome = commission(options(trials=3), lambda what, fraction, note="": steps.append((what, note)))
    trials = outcome.rounds[0].trials
    assert len(trials) == 3
    journal = outcome.trials.journal
    steps_back = [journal.get(f"after-trial-{number:02d}") is None for number in (1, 2, 3)]
    assert steps_back == [True] * 3, "what ended a trial, or was restless twice, is led back without a search"
    beside = [errors_beside(outcome.predicted(trial, outcome.rounds[0]), trial) for trial in trials]
    assert [step for step in steps if "trial" in step[0]] == [
        (f"round 1, trial {number} of 3 at most: recording", note) for number, note in enumerate(["", *beside[:2]], 1)
    ]
    rig.before = rig.stored = outcome.trials.table
    trials = commission(options(out=tmp_path / "all good", judging=ending(good_error_share=1.0))).rounds[0].trials
    assert [one.whole for one in trials] == [False, True], "a trial that a joint ended is no end of a round"


def test_what_failed_is_searched_again_and_what_did_not_keeps_its_controller(whole: Whole) -> None:
    """Joint 2 hunts, and ends the check for all."""
    first, second = whole.outcome.rounds[0].trials[:2]
    failed = [verdict.known and not verdict.passed for verdict in first.verdicts]
    assert failed == [False, False, True, False]
    assert (first.rows != second.rows).any(axis=1).tolist() == failed


def test_a_joint_far_behind_what_its_model_promised_gets_its_tuned_controller(
    options: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The set of the search passes, but it leaves joint 1 what it had."""

    def search(check: CheckOnModel, begin: np.ndarray, vary: np.ndarray, *other: object) -> np.ndarray:
        rows = begin.copy()
        if vary.all():
            rows[1] = check.trials.before.rows[1]
            rows[2, KP] //= 8
        return rows

    monkeypatch.setattr(CheckOnModel, "search", search)
    outcome = commission(options(trials=2))
    first, second = outcome.rounds[0].trials
    assert first.passes_at_a_price
    tuned = outcome.rounds[0].learnt.tuned
    assert (second.rows != first.rows).any(axis=1).tolist() == [False, True, False, False]
    assert np.array_equal(outcome.best.rows[1], tuned[1])
    searched = [outcome.trials.journal.get(f"after-trial-{number:02d}") is not None for number in (1, 2)]
    assert searched == [True, False], "joint 3, which rattles, is searched again, but not after the last trial"


def test_the_summary_says_what_the_tuned_set_alone_leaves(whole: Whole) -> None:
    outcome = whole.outcome
    told = outcome.as_dict()
    assert outcome.tuned is not None
    assert (told["score"], told["tuned_score"]) == pytest.approx((outcome.best.score, outcome.tuned.score), abs=1e-4)
    assert not told["tuned_measured"], "joint 2 ended the one trial of its tuned controller"
    left, alone = 100.0 * outcome.best.score, 100.0 * outcome.tuned.score
    said = f"{left:.1f} % is left now. The tuned set alone leaves {alone:.1f} %"
    assert f"{said} by the model; joint 2 (wrist pitch) hunted with it." in outcome.text()


@pytest.mark.parametrize(
    ("hoped", "enough"),
    [([0.03], True), ([1.0, 1.0, 1.0], False), ([1.0, 1.0, 1.0, 0.5], False), ([0.3, 0.29, 0.28, 0.28], True)],
    ids=["good", "still restless", "rests at last", "gains no more"],
)
def test_joints_that_follow_well_or_gain_no_more_get_no_more_trials(hoped: list[float], enough: bool) -> None:
    assert run.is_enough(hoped) == enough


def test_a_model_of_another_arm_is_refused_before_it_moves_the_board(rig: SimulatedRig, options: Make) -> None:
    other = make_arm(joint_1={"motor": {"resistance": 5.0 * default_arm().joint[1].motor.resistance}})
    path = write_model(options().out.parent / "other.toml", other)
    with pytest.raises(UserError, match="other.toml .*: joint 1"):
        commission(options(model=path))
    assert all(table == rig.before for table in rig.played), "nothing but the controllers from before has run"


def test_a_finished_commissioning_needs_no_arm_to_tell_its_story_again(rig: SimulatedRig, whole: Whole) -> None:
    assert commission(whole.options(resume=True)).as_dict() == whole.outcome.as_dict()
    assert rig.played == []


def test_without_a_model_the_arm_is_excited_and_identified(
    rig: SimulatedRig, options: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The identification itself has tests of its own; here it is enough that it gets the right logs."""
    steps: list[tuple[str, list[str]]] = []
    begun: list[ArmParameters | None] = []

    class Found:
        complete = True

        def save(self, path: Path) -> None:
            path.write_bytes(Path(str(options().model)).read_bytes())

    def note(step: str, logs: Sequence[Log], tables: Sequence[ParameterTable]) -> Found:
        assert {log.origin.param_crc for log in logs} <= {table.crc for table in tables}
        steps.append((step, [Path(log.name).stem for log in logs]))
        return Found()

    def identify(logs, nominal, *, tables, seed, begin, report, judging):  # type: ignore[no-untyped-def]
        begun.append(begin)
        return note("fit", logs, tables)

    monkeypatch.setattr(learn, "identify", identify)
    monkeypatch.setattr(learn, "validated", lambda found, logs, tables: note("validate", logs, tables))
    monkeypatch.setattr(run, "GOOD_BUDGET", 2)
    outcome = commission(options(model=None, rounds=2, trials=2, judging=ending(max_error_share=0.0)))
    assert begun == [None, outcome.rounds[0].learnt.arm], "the second model goes on from the first"
    played = [one.name for one in outcome.rounds[0].trials if not one.stopped]
    assert steps == [
        ("fit", ["excite"]),
        ("validate", ["before"]),
        ("fit", ["excite", *played]),
        ("validate", ["before"]),
    ]
    journal = outcome.trials.journal
    excited_s = load_leader(journal.path("excite_leader.csv")).duration_s
    assert read_log(journal.path("excite.csv")).time[-1] > excited_s - 1.0


def test_the_report_shows_predicted_beside_measured(whole: Whole, tmp_path: Path) -> None:
    outcome = whole.outcome
    shown = facts(outcome)
    trial = shown["rounds"][0]["trials"][-1]
    error = next(row for row in trial["rows"] if row["name"] == "error, reaches")
    for cell in error["cells"]:
        assert float(cell["predicted"]) == pytest.approx(float(cell["measured"]), rel=0.5), (
            "the model is that of the arm"
        )
    page = save_page(outcome, tmp_path / "report.html").read_text(encoding="utf-8")
    assert error["cells"][0]["measured"] in page
    assert "data:image/png;base64," in page
    assert page.count("now on the board") == 1


def test_of_an_arm_with_two_joints_those_are_tried_and_the_others_keep_what_they_had(
    tmp_path: Path, options: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    arm, before = load_arm("two_joints"), ParameterTable.defaults().with_joints((0, 1))
    rig = SimulatedRig(arm, before)
    monkeypatch.setattr(run, "connected", rig.connected)
    (tmp_path / "arm.toml").write_text(arm_toml(arm, "Two joints."), encoding="utf-8")
    model = write_model(tmp_path / "two.toml", arm, joints=(0, 1), parameters=before.changes())
    outcome = commission(options(model=model, arm_file=str(tmp_path / "arm.toml"), trials=2))
    assert outcome.improved
    assert outcome.best.passes_at_a_price
    assert [verdict.score < 0.5 for verdict in outcome.best.verdicts] == [True] * 4
    assert outcome.best.score > 1e-3, "joints that are not in use do not count"
    assert rig.stored.joints_in_use == (0, 1)
    assert "joint 2" not in outcome.text()
    assert "base yaw  shoulder pitch\n" in outcome.text()
    told = facts(outcome)
    assert told["joints"] == ["0 base yaw", "1 shoulder pitch"]
    assert len(told["before"]["rows"][0]["cells"]) == 2


def test_a_commissioning_reads_no_limits_but_those_that_it_was_handed(
    rig: SimulatedRig, options: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    """But to say in its journal in which it differs from the usual ones."""
    in_no_time(rig, monkeypatch)
    request = options(trials=2, judging=copy_of(COMMISSIONING_LIMITS))
    monkeypatch.setattr(type(request), "facts", lambda request: {})
    with reads_of(COMMISSIONING_LIMITS) as read:
        commission(request)
    assert read == set()


def test_other_limits_are_another_commissioning(options: Make) -> None:
    assert "judging" not in options().facts()
    assert options(judging=ending(min_gain=0.2)).facts()["judging"] == {"rounds.min_gain": 0.2}
