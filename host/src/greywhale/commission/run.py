"""A commissioning as a whole: what the arm does before, then rounds of a model, controllers, and trials on the arm.

The first round learns while the arm plays the check with the controllers from before: its model needs the excitation
alone. The arm is connected only while it is measured. The controllers on trial are never stored; the board keeps those
from before until the end, when it gets the best that was measured.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.errors import BadUsage, UserError
from greywhale.base.study.side_job import SideJobs, side_jobs
from greywhale.base.types import Controllers, Flags, Floats, NotedProgress, show_no_progress
from greywhale.commission import learn, start
from greywhale.commission.arm_on_port import ArmOnPort, connected
from greywhale.commission.choose import JointTrials, Row, combine_best, confirm
from greywhale.commission.evidence import Evidence, failing_plants, to_fit, to_validate
from greywhale.commission.foresee import foresee
from greywhale.commission.journal import AnewError, CommissioningJournal
from greywhale.commission.limits import COMMISSIONING_LIMITS, RoundLimits
from greywhale.commission.motions import JointRange, check_motion
from greywhale.commission.request import CommissioningRequest
from greywhale.commission.result import CommissioningResult, Round, errors_beside, predict_trial
from greywhale.commission.search import CheckOnModel
from greywhale.commission.trials import Trial, Trials
from greywhale.files.arm import load_arm
from greywhale.files.leader import load_leader, save_leader
from greywhale.files.log import read_evidence
from greywhale.files.parameter_file import load as load_parameters
from greywhale.files.parameter_file import save as save_parameters
from greywhale.identify.excite import design
from greywhale.identify.excite.design import GOOD_BUDGET
from greywhale.identify.excite.limits import limits_of
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import ParameterTable, find_board
from greywhale.tune.board_checks import refuse_uncalibrated
from greywhale.tune.model_checks import doubt_other_arm

EXCITING = "excite_leader.csv"


def is_enough(hoped: Sequence[float], limits: RoundLimits = COMMISSIONING_LIMITS.rounds) -> bool:
    """True where a round's trials end here; `hoped` is the error of the joints' best together after each of them,
    relative to before.
    """
    patience = limits.trials_without_gain
    stalls = len(hoped) > patience and hoped[-1] > (1.0 - limits.min_gain) * hoped[-1 - patience]
    return stalls or hoped[-1] <= limits.good_error_share


def _failed(trial: Trial) -> Flags:
    """Joints (4,) that have a fault."""
    return np.array([bool(verdict.faults) for verdict in trial.verdicts])


def commission(options: CommissioningRequest, report: NotedProgress | None = None) -> CommissioningResult:
    """Find controllers on the arm; the board then runs and stores the best that was measured. Raises UserError."""
    return _Commissioning(options, report or show_no_progress).run()


def _design(
    options: CommissioningRequest,
    nominal: ArmParameters,
    pose: Floats,
    table: ParameterTable,
    path: Path,
    report: NotedProgress,
) -> None:
    """Design the motion that shows most about the arm."""
    designed = design(
        nominal,
        pose,
        table=table,
        ranges=options.ranges,
        seed=options.seed,
        budget=GOOD_BUDGET,
        report=report,
        judging=options.judging.tuning.identification,
    )
    save_leader(path, designed.motion)


class _Commissioning:
    def __init__(self, options: CommissioningRequest, report: NotedProgress) -> None:
        self.options = options
        self.report = report
        self.nominal = load_arm(options.arm_file or options.model or "white_box")
        if options.arm_file is not None and options.model is not None:
            for doubt in doubt_other_arm(load_arm(options.model), self.nominal, options.arm_file):
                raise UserError(f"{options.model}: {doubt.reason}; {doubt.remedy}.")
        self.rounds: list[Round] = []
        self.joints: list[JointTrials] = []
        self.before: ParameterTable | None = None
        self.stage = "before"
        self.trying = ""  # which trial of a round runs, for the reports
        self.tried = ""  # how the last one went, for those that say nothing else

    def run(self) -> CommissioningResult:
        options = self.options
        with CommissioningJournal(options.out, options.facts(), options.resume) as self.journal:
            try:
                return self._run()
            except (UserError, KeyboardInterrupt) as ending:
                self._say_how_to_go_on(ending)
                raise

    def _say_how_to_go_on(self, ending: UserError | KeyboardInterrupt) -> None:
        again = f"The same command with --resume goes on in the folder {self.options.out}."
        if isinstance(ending, KeyboardInterrupt):
            ending.add_note(f"The board keeps the controllers from before. {again}")
        elif not isinstance(ending, AnewError | BadUsage) and "--resume" not in ending.message:
            ending.add_note(again)

    def _run(self) -> CommissioningResult:
        number, learnt = 1, self._begin()
        while True:
            first = len(self.trials.done)
            with self._connection() as connect:
                self._try(connect, learnt)
                self.rounds.append(Round(number, learnt, tuple(self.trials.done[first:])))
                if number == self.options.rounds or not self._needs_another_round():
                    return self._confirm(connect)
            number += 1
            learnt = self._learn(number)

    def _confirm(self, connect: Callable[[], ArmOnPort]) -> CommissioningResult:
        self.stage = "confirming"
        best = confirm(self.trials, self.joints, connect, self.rounds[-1].learnt.fallback)
        if self.journal.get("end") is None:
            if best is not self.trials.before:
                connect().keep(best.table)
            self.journal.note("end", {"best": best.name})
        return CommissioningResult(self.trials, tuple(self.rounds), best)

    def _begin(self) -> learn.LearntController:
        """Excite the arm, then play the check with the controllers from before, while the first round learns."""
        with side_jobs(self._report) as jobs:
            with self._connection() as connect:
                self._find_joint_range(connect, jobs)
                tuner = self._tuner(1, None if self.options.model else to_fit(self._excite(connect), self.trials))
                job = jobs.begin(tuner.tune)
                self._play_before(connect)
            self.stage = "round 1"
            tuned = job.result()
        return self._finish(tuner, tuned)

    def _find_joint_range(self, connect: Callable[[], ArmOnPort], jobs: SideJobs) -> None:
        """Refuse what must not move, find out where the joints may go, and design the excitation if it comes next."""
        options, journal = self.options, self.journal
        facts = journal.get("start")
        if facts is None:
            arm = connect()
            wanted = options.judging.tuning.identification.excitation
            refuse_uncalibrated(self.nominal, arm.before, options.judging.tuning.model)
            limits = limits_of(self.nominal, arm.before, arm.pose(), options.ranges or {}, wanted)
            joint_range = JointRange(limits.pose, limits.low, limits.high)
            if options.model is None:
                job = jobs.begin(self._designing(joint_range, arm.before))
                start.refuse_stuck(arm, journal, joint_range, options.judging.motion)
                job.result()
            else:
                start.refuse_stuck(arm, journal, joint_range, options.judging.motion)
            save_parameters(journal.path("before.toml"), arm.before)
            facts = {
                "board": arm.before.board.key,
                "room": [array.tolist() for array in (joint_range.pose, joint_range.low, joint_range.high)],
            }
            journal.note("start", facts)
        self.before = before = load_parameters(journal.path("before.toml")).for_board(find_board(facts["board"]))
        self.joint_range = JointRange(*(np.array(values) for values in facts["room"]))
        self.trials = Trials(journal, check_motion(self.joint_range, options.judging.motion), before, options.judging)

    def _play_before(self, connect: Callable[[], ArmOnPort]) -> None:
        self.stage = "before"
        trials, options = self.trials, self.options
        first = trials.play_before(connect)
        rows = controllers_of(trials.table)
        self.joints = [JointTrials() for _ in range(JOINTS)]
        for one, row, verdict in zip(self.joints, rows, first.verdicts, strict=True):
            one.add(row, verdict)
        if options.model is not None:
            most = options.judging.rounds.max_model_error
            learn.refuse_other_arm(load_arm(options.model), str(options.model), first, trials.table, most)

    def _learn(self, number: int) -> learn.LearntController:
        """The model and controllers of a later round."""
        with self._connection() as connect:
            fit = to_fit(self._excite(connect), self.trials)
        self.stage = f"round {number}"
        tuner = self._tuner(number, fit)
        return self._finish(tuner, tuner.tune(self._report))

    def _tuner(self, number: int, fit: Evidence | None) -> learn.RoundTuner:
        return learn.RoundTuner(
            self.journal,
            number,
            self.options,
            self.nominal,
            fit,
            begin=self.rounds[-1].learnt.arm if self.rounds else None,
            start=combine_best(self.trials, self.joints) if self.joints else controllers_of(self.trials.table),
            failing=partial(failing_plants, trials=self.trials),
        )

    def _finish(self, tuner: learn.RoundTuner, tuned: learn.UnvalidatedTuning | None) -> learn.LearntController:
        """Return what a round learnt, with controllers that its model prefers on the check."""
        trials = self.trials
        model, learnt = tuner.validate(tuned, to_validate(trials))
        before = trials.before
        trials.foresight = foresight = foresee(
            model.arm, trials.table, trials.check, before.traces, before.measured, trials.judging
        )
        trials.others |= learnt.others
        self.on_model = CheckOnModel.of(model, trials, foresight, self.options.seed, self.options.threads)
        found = self._search_on_model(f"on-model-{tuner.number}", learnt.tuned, np.ones(JOINTS, dtype=bool))
        return replace(learnt, controllers=found, promised=self.on_model.scores(np.stack([learnt.tuned, found])))

    def _search_on_model(self, name: str, begin: Controllers, vary: Flags) -> Controllers:
        """Controllers around others that the round's model prefers on the check; noted in the journal."""
        facts = self.journal.get(name)
        if facts is None:
            found = self.on_model.search(begin, vary, self.options.seed, self._report)
            facts = {"controllers": found.tolist()}
            self.journal.note(name, facts)
        return np.array(facts["controllers"], dtype=np.int32)

    def _designing(self, joint_range: JointRange, table: ParameterTable) -> Callable[[NotedProgress], None]:
        path = self.journal.path(EXCITING)
        return partial(_design, self.options, self.nominal, joint_range.pose, table, path)

    def _excite(self, connect: Callable[[], ArmOnPort]) -> Evidence:
        """The log of that motion, and what the board ran in it."""
        self.stage = "excite"
        path, trials = self.journal.path("excite.csv"), self.trials
        facts = self.journal.get("excite")
        if facts is None:
            if self.options.model is not None:
                self._designing(self.joint_range, trials.table)(self._report)
            motion = load_leader(self.journal.path(EXCITING))
            while (played := connect().play(motion, path, trials.table, patient=True, watched=False)).stopped:
                trials.soften(played, f"the arm cannot be excited: {played.stopped}; narrow the --range.")
            facts = {"log": path.name, "controllers": controllers_of(trials.table).tolist()}
            self.journal.note("excite", facts)
        return Evidence((read_evidence(path),), (trials.table.with_controllers(facts["controllers"]),))

    def _try(self, connect: Callable[[], ArmOnPort], learnt: learn.LearntController) -> None:
        """Try a round's controllers on the arm, and then others in the place of those that fail or follow poorly."""
        trials, rows, self.improving = self.trials, learnt.controllers, True
        hoped: list[float] = []
        for number in range(1, self.options.trials + 1):
            self.trying = f", trial {number} of {self.options.trials} at most"
            trial = trials.play(connect, rows)
            self.tried = errors_beside(predict_trial(learnt.arm, trial, trials.check), trial)
            for one, row, verdict in zip(self.joints, rows, trial.verdicts, strict=True):
                if verdict.known:
                    one.add(row, verdict)
            if trial.whole:
                hoped.append(sum(one.best.verdict.share * one.best.verdict.ranking_cost for one in self.joints))
            untried = self._poor(learnt) & ~self._have_tried(learnt.fallback)
            if number == self.options.trials or (
                trial.whole and not untried.any() and is_enough(hoped, self.options.judging.rounds)
            ):
                break
            rows = self._improve(trial, learnt) if trial.whole else self._calm(trial, learnt)
            if any(np.array_equal(rows, known.rows) for known in trials.done):
                break
        self.trying = ""

    def _calm(self, trial: Trial, learnt: learn.LearntController) -> Controllers:
        """The set after one that the arm did not play to its end: softer joints where they failed, else all of them."""
        rows = trial.rows.copy()
        failed = _failed(trial)
        for joint in np.flatnonzero(failed if failed.any() else (rows != self.trials.before.rows).any(axis=1)).tolist():
            rows[joint] = self._calmer(joint, learnt)
        return rows

    def _improve(self, trial: Trial, learnt: learn.LearntController) -> Controllers:
        """The set after a whole trial. What failed is searched again with what the arm showed, and made softer where
        it was restless before; what follows poorly gets its tuned controller, and then one more search.
        """
        failed, poor, tried = _failed(trial), self._poor(learnt), self._have_tried(learnt.fallback)
        passed = np.array([verdict.passed for verdict in trial.verdicts])
        begin = np.where(passed[:, None], combine_best(self.trials, self.joints), trial.rows)
        restless = failed & np.array([len(one.restless) > 1 for one in self.joints])
        for joint in np.flatnonzero(restless).tolist():
            begin[joint] = self._calmer(joint, learnt)
        simply = ~failed & poor & ~tried
        begin[simply] = learnt.fallback[simply]
        again = ~failed & poor & tried & self.improving
        self.improving &= not again.any()
        vary = (failed & ~restless) | again
        if not vary.any():
            return begin
        self.on_model = self.on_model.corrected(trial)
        return self._search_on_model(f"after-{trial.name}", begin, vary)

    def _calmer(self, joint: int, learnt: learn.LearntController) -> Row:
        return self.joints[joint].calmer(learnt.fallback[joint], self.options.judging.rounds.softer_shares)

    def _poor(self, learnt: learn.LearntController) -> Flags:
        """Joints (4,) whose best follows much worse than the model promises."""
        rounds = self.options.judging.rounds
        most = np.maximum(rounds.poor_times * learnt.promised.min(axis=0), rounds.poor_error_share)
        costs = np.array([one.best.verdict.ranking_cost for one in self.joints])
        found: Flags = costs > most
        return found

    def _have_tried(self, rows: Controllers) -> Flags:
        return np.array([one.has_tried(row) for one, row in zip(self.joints, rows, strict=True)])

    def _needs_another_round(self) -> bool:
        """True where another round may help: a joint follows little better than before, or poorly."""
        rounds, poor = self.options.judging.rounds, self._poor(self.rounds[-1].learnt)
        costs = np.array([one.best.verdict.ranking_cost for one in self.joints])
        return bool((costs > np.where(poor, rounds.poor_again_share, rounds.max_error_share)).any())

    def _report(self, what: str, fraction: float, note: str = "") -> None:
        self.report(f"{self.stage}{self.trying}: {what}", fraction, note or self.tried)

    @contextmanager
    def _connection(self) -> Iterator[Callable[[], ArmOnPort]]:
        """The arm, connected when it is first asked for, and left with its motors off at the end."""
        with ExitStack() as stack:
            yield cache(
                lambda: stack.enter_context(connected(self.options.port, self.before, self.nominal, self._report))
            )
