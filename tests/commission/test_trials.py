"""Trials: judged against the controllers from before, kept in the journal, and the best of them that passed whole."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.commission.arm_on_port import ArmOnPort, PlayedMotion
from greywhale.commission.limits import COMMISSIONING_LIMITS
from greywhale.commission.result import CommissioningResult
from greywhale.commission.trials import Trial, Trials
from greywhale.files.trajectory import Trajectory
from greywhale.loop.controllers import controllers_of
from greywhale.measure.limits import SWING_LIMITS
from greywhale.protocol.table import ParameterTable
from tests.commission.simulated import KD, KI, KP
from tools.support.simulated_rig import SimulatedRig

BETTER, WILD = 2.0, 40.0  # times the stiffness of before


def stiffer(trials: Trials, joints: Sequence[int], factor: float) -> np.ndarray:
    rows = controllers_of(trials.table).copy()
    for joint in joints:
        rows[joint, KP] *= factor
        rows[joint, KD] *= factor**0.5
        rows[joint, KI] *= factor
    return rows


def play(trials: Trials, rig: SimulatedRig, rows: np.ndarray) -> Trial:
    return trials.play(lambda: rig, rows)  # type: ignore[arg-type, return-value]


def play_before(trials: Trials, rig: SimulatedRig) -> Trial:
    return trials.play_before(lambda: rig)  # type: ignore[arg-type, return-value]


def no_arm() -> ArmOnPort:
    raise LookupError("an arm is asked for")


def test_better_controllers_pass_and_are_ranked(trials: Trials, rig: SimulatedRig) -> None:
    before = play_before(trials, rig)
    some = play(trials, rig, stiffer(trials, [1], BETTER))
    more = play(trials, rig, stiffer(trials, [0, 1, 2], BETTER))
    assert all(trial.passed for trial in (before, some, more))
    assert trials.ranked() == [more, some, before]
    assert more.verdicts[1].score < 0.7


def judged(trial: Trial, faults: tuple[str, ...], passes_at_a_price: bool, score: float) -> Trial:
    """The trial with other verdicts: joint 0 has these faults, and all joints follow alike."""
    verdicts = [replace(one, faults=(), passes_at_a_price=True, score=score, share=0.25) for one in trial.verdicts]
    excess = SWING_LIMITS.bearable_excess
    verdicts[0] = replace(verdicts[0], faults=faults, passes_at_a_price=passes_at_a_price, excess=excess)
    return replace(trial, verdicts=tuple(verdicts))


@pytest.mark.parametrize(
    ("passes_at_a_price", "score", "taken"),
    [(True, 0.63, True), (True, 0.65, False), (False, 0.1, False)],
    ids=["follows far better", "follows hardly better", "is too restless"],
)
def test_a_little_unrest_has_its_price(
    trials: Trials, rig: SimulatedRig, passes_at_a_price: bool, score: float, taken: bool
) -> None:
    """One of four joints rests as unquietly as can be borne: its error counts twice."""
    trial = play_before(trials, rig)
    quiet = judged(trial, (), True, 0.8)
    restless = judged(trial, ("it hunts at rest",), passes_at_a_price, score)
    trials.done += [quiet, restless]
    assert trials.ranked()[0] is (restless if taken else quiet)


def test_the_summary_says_what_is_borne_and_fits_a_terminal(trials: Trials, rig: SimulatedRig) -> None:
    fault = "it hunts at rest (2.2 mrad rms, at most 2.0)"
    restless = judged(play_before(trials, rig), (fault,), True, 0.1)
    said = f"Joint 0 (base yaw): {fault}. No quieter controller follows as well."
    text = CommissioningResult(trials, (), restless).text()
    assert said in text
    assert said not in CommissioningResult(trials, (), judged(trials.before, (), True, 0.1)).text()
    measured = 1e3 * np.sqrt(restless.measured.error[1, 3])
    assert f"-> {measured:.1f}\n" in next(line + "\n" for line in text.splitlines() if line.startswith("moves "))
    assert text.startswith(f"The board now runs and stores {restless.name}")
    table = text.splitlines()[2 : text.splitlines().index(said)]
    assert max(map(len, table)) <= 80


def test_what_is_in_the_journal_needs_no_arm(trials: Trials, rig: SimulatedRig) -> None:
    """But the logs as they were recorded."""
    sets = [stiffer(trials, [0], BETTER), stiffer(trials, [3], WILD)]
    before = play_before(trials, rig)
    first = [play(trials, rig, rows) for rows in sets]
    again = Trials(trials.journal, trials.check, trials.table)
    assert again.play_before(no_arm).as_dict() == before.as_dict()
    for rows, known in zip(sets, first, strict=True):
        assert again.play(no_arm, rows).as_dict() == known.as_dict()
    with pytest.raises(LookupError):
        again.play(no_arm, sets[0])
    before.path.write_text("".join(before.path.read_text().splitlines(keepends=True)[:-100]))
    with pytest.raises(UserError, match=r"before\.csv: only \d+ of its \d+ rows are there"):
        Trials(trials.journal, trials.check, trials.table).play_before(no_arm)


def test_a_journal_that_another_version_made_is_refused_in_a_sentence(trials: Trials, rig: SimulatedRig) -> None:
    play_before(trials, rig)
    play(trials, rig, stiffer(trials, [0], BETTER))
    again = Trials(trials.journal, trials.check, trials.table)
    again.play_before(no_arm)
    with pytest.raises(UserError, match="trial-01 of this commissioning was made by another version"):
        again.play(no_arm, stiffer(trials, [1], BETTER))


def test_controllers_from_before_that_the_board_stops_are_refused(trials: Trials, rig: SimulatedRig) -> None:
    wild = Trials(trials.journal, trials.check, trials.table_of(stiffer(trials, [1], WILD)))

    class Stopping(SimulatedRig):
        def play(self, *given: object, **options: object):  # type: ignore[no-untyped-def]
            played = super().play(*given, **options)  # type: ignore[arg-type]
            return type(played)(played.log, "the board stopped", 1)

    with pytest.raises(UserError, match="ended early: the board stopped"):
        wild.play_before(lambda: Stopping(rig.arm))  # type: ignore[arg-type, return-value]


class SwingingRig(SimulatedRig):
    """Its joint 1 swings until the board stops it, where it has more voltage than `calm_mv`."""

    calm_mv = 0

    def play(self, motion: Trajectory, path: Path, table: ParameterTable, **options: bool) -> PlayedMotion:
        played = super().play(motion, path, table, **options)
        swings = table["joint1.ku_mv"] > self.calm_mv
        return replace(played, stopped="the board stopped", joint=1, swung=True) if swings else played


def test_a_joint_that_swings_is_measured_with_less_voltage_and_so_when_it_goes_on(
    trials: Trials, rig: SimulatedRig
) -> None:
    table = trials.table
    swinging = SwingingRig(rig.arm)
    swinging.calm_mv = table["joint1.ku_mv"] // 4
    before = trials.play_before(lambda: swinging)  # type: ignore[arg-type, return-value]
    assert before.whole
    assert trials.softened == [1, 1]
    assert before.table.with_raw({f"joint1.{key}": table[f"joint1.{key}"] for key in ("ki", "ku_mv")}) == table
    assert before.table["joint1.ku_mv"] == swinging.calm_mv
    again = Trials(trials.journal, trials.check, table)
    assert again.play_before(no_arm).as_dict() == before.as_dict()
    nothing_passed = CommissioningResult(trials, (), before)
    assert "swung until the board stopped it; with 1/4 of that voltage" in nothing_passed.text()
    assert not nothing_passed.improved
    assert nothing_passed.table == table, "the board keeps what it stored"


def test_a_joint_that_swings_however_soft_it_is_is_refused(trials: Trials, rig: SimulatedRig) -> None:
    with pytest.raises(UserError, match="ended early: the board stopped; narrow the --range, or upload calmer"):
        trials.play_before(lambda: SwingingRig(rig.arm))  # type: ignore[arg-type, return-value]
    assert trials.softened == [1] * COMMISSIONING_LIMITS.motion.softer_starts
