"""A commissioning as a whole: what the arm does before, then rounds of a model, controllers, and trials on the arm.

The first round learns while the arm plays the check with the controllers from before: its model needs the excitation
alone. The arm is connected only while it is measured. The controllers on trial are never stored; the board keeps those
from before until the end, when it gets the best that was measured.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace

import numpy as np

from greywhale.base.errors import BadUsage, UserError
from greywhale.base.side_job import SideJob
from greywhale.base.types import Controllers, Flags, NotedProgress, show_no_progress
from greywhale.commission import learn, start
from greywhale.commission.arm_on_port import ArmOnPort, connected
from greywhale.commission.choose import JointTrials, confirm
from greywhale.commission.evidence import Evidence, failing_plants, to_fit, to_validate
from greywhale.commission.foresee import foresee
from greywhale.commission.journal import AnewError, CommissioningJournal
from greywhale.commission.limits import COMMISSIONING_LIMITS, RoundLimits
from greywhale.commission.motions import JointRange, check_motion
from greywhale.commission.request import CommissioningRequest
from greywhale.commission.result import CommissioningResult, Round, errors_beside, predict_trial
from greywhale.commission.search import CheckOnModel
from greywhale.commission.trials import Trials
from greywhale.files.arm import load_arm
from greywhale.files.leader import load_leader, save_leader
from greywhale.files.log import Log, read_evidence
from greywhale.files.parameter_file import load as load_parameters
from greywhale.files.parameter_file import save as save_parameters
from greywhale.identify.excite import design
from greywhale.identify.excite.limits import limits_of
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import ParameterTable, find_board
from greywhale.tune.board_checks import refuse_uncalibrated
from greywhale.tune.model_checks import doubt_other_arm

EXCITING = "excite_leader.csv"
DESIGN_BUDGET = 150  # the last evaluations of a search for a motion would gain little


def is_enough(hoped: Sequence[float], limits: RoundLimits = COMMISSIONING_LIMITS.rounds) -> bool:
    """Whether a round's trials end here; `hoped` is the error of the joints' best together after each of them, relative
    to before.
    """
    patience = limits.trials_without_gain
    stalls = len(hoped) > patience and hoped[-1] > (1.0 - limits.min_gain) * hoped[-1 - patience]
    return stalls or hoped[-1] <= limits.good_error_share


def commission(options: CommissioningRequest, report: NotedProgress | None = None) -> CommissioningResult:
    """Find controllers on the arm; the board then runs and stores the best that was measured. Raises UserError."""
    return _Commissioning(options, report or show_no_progress).run()


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
        with CommissioningJournal(options.out, options.facts(), options.resume) as self.book:
            try:
                return self._run()
            except (UserError, KeyboardInterrupt) as ending:
                self._say_how_to_go_on(ending)
                raise

    def _say_how_to_go_on(self, ending: UserError | KeyboardInterrupt) -> None:
        again = f"The same command with --resume goes on in {self.options.out}."
        if isinstance(ending, KeyboardInterrupt):
            ending.add_note(f"The board keeps the controllers from before. {again}")
        elif not isinstance(ending, AnewError | BadUsage) and "--resume" not in ending.message:
            ending.add_note(again)

    def _run(self) -> CommissioningResult:
        number, learnt = 1, self._begin()
        while True:
            first = len(self.trials.done)
            with self._arm() as arm:
                self._try(arm, learnt)
                self.rounds.append(Round(number, learnt, tuple(self.trials.done[first:])))
                if number == self.options.rounds or not self._needs_another_round():
                    return self._confirm(arm)
            number += 1
            learnt = self._learn(number)

    def _confirm(self, arm: Callable[[], ArmOnPort]) -> CommissioningResult:
        self.stage = "confirming"
        best = confirm(self.trials, self.joints, arm)
        if self.book.get("end") is None:
            arm().keep(best.table)
            self.book.note("end", {"best": best.name})
        return CommissioningResult(self.trials, tuple(self.rounds), best)

    def _begin(self) -> learn.LearntController:
        """Excite the arm, then play the check with the controllers from before, while the first round learns."""
        with ExitStack() as stack:
            with self._arm() as arm:
                self._find_room(arm)
                tuner = self._tuner(1, None if self.options.model else to_fit(self._excite(arm), self.trials))
                job = stack.enter_context(SideJob(tuner.tune, self._report))
                self._play_before(arm)
            self.stage = "round 1"
            return self._finish(tuner, job.result())

    def _find_room(self, arm: Callable[[], ArmOnPort]) -> None:
        """Refuse what must not move, find out where the joints may go, and design the excitation if it comes next."""
        options, book = self.options, self.book
        facts = book.get("start")
        if facts is None:
            rig = arm()
            wanted = options.judging.tuning.identification.excitation
            refuse_uncalibrated(self.nominal, rig.before, options.judging.tuning.model)
            limits = limits_of(self.nominal, rig.before, rig.pose(), options.ranges or {}, wanted)
            room = JointRange(limits.pose, limits.low, limits.high)
            if options.model is None:
                with SideJob(lambda report: self._design(room, rig.before, report), self._report) as job:
                    start.refuse_stuck(rig, book, room, options.judging.motion)
                    job.result()
            else:
                start.refuse_stuck(rig, book, room, options.judging.motion)
            save_parameters(book.path("before.toml"), rig.before)
            facts = {
                "board": rig.before.board.key,
                "room": [array.tolist() for array in (room.pose, room.low, room.high)],
            }
            book.note("start", facts)
        self.before = before = load_parameters(book.path("before.toml")).for_board(find_board(facts["board"]))
        self.room = JointRange(*(np.array(values) for values in facts["room"]))
        self.trials = Trials(book, check_motion(self.room, options.judging.motion), before, options.judging)

    def _play_before(self, arm: Callable[[], ArmOnPort]) -> None:
        self.stage = "before"
        trials, options = self.trials, self.options
        first = trials.play_before(None if trials.known() else arm())
        rows = controllers_of(trials.table)
        self.joints = [JointTrials() for _ in range(JOINTS)]
        for one, row, verdict in zip(self.joints, rows, first.verdicts, strict=True):
            one.add(row, verdict)
        if options.model is not None:
            most = options.judging.rounds.max_model_error
            learn.refuse_other_arm(load_arm(options.model), str(options.model), first, trials.table, most)

    def _learn(self, number: int) -> learn.LearntController:
        """The model and controllers of a later round."""
        with self._arm() as arm:
            fit = to_fit(self._excite(arm), self.trials)
        self.stage = f"round {number}"
        tuner = self._tuner(number, fit)
        return self._finish(tuner, tuner.tune(self._report))

    def _tuner(self, number: int, fit: Evidence | None) -> learn.RoundTuner:
        return learn.RoundTuner(
            self.book,
            number,
            self.options,
            self.nominal,
            fit,
            begin=self.rounds[-1].learnt.arm if self.rounds else None,
            start=self._best_rows(),
            failing=lambda arm: failing_plants(arm, self.trials),
        )

    def _finish(self, tuner: learn.RoundTuner, tuned: learn.UnvalidatedTuning | None) -> learn.LearntController:
        """What a round learnt, with controllers that its model prefers on the check."""
        trials = self.trials
        model, learnt = tuner.validate(tuned, to_validate(trials))
        before = trials.before
        trials.foresight = foresight = foresee(
            model.arm, trials.table, trials.check, before.traces, before.measured, trials.judging
        )
        trials.others |= learnt.others
        self.on_model = CheckOnModel.of(model, trials, foresight, self.options.seed, self.options.threads)
        found = self._search_on_model(f"on-model-{tuner.number}", learnt.controllers, np.ones(JOINTS, dtype=bool))
        return replace(learnt, controllers=found)

    def _search_on_model(self, name: str, begin: Controllers, vary: Flags) -> Controllers:
        """Controllers around others that the round's model prefers on the check; noted in the journal."""
        facts = self.book.get(name)
        if facts is None:
            found = self.on_model.search(begin, vary, self.options.seed, self._report)
            facts = {"controllers": found.tolist()}
            self.book.note(name, facts)
        return np.array(facts["controllers"], dtype=np.int32)

    def _design(self, room: JointRange, table: ParameterTable, report: NotedProgress) -> None:
        """Design the motion that shows most about the arm."""
        designed = design(
            self.nominal,
            room.pose,
            table=table,
            ranges=self.options.ranges,
            seed=self.options.seed,
            budget=DESIGN_BUDGET,
            report=report,
            judging=self.options.judging.tuning.identification,
        )
        save_leader(self.book.path(EXCITING), designed.motion)

    def _excite(self, arm: Callable[[], ArmOnPort]) -> Log:
        """The log of that motion."""
        self.stage = "excite"
        path, table = self.book.path("excite.csv"), self.trials.table
        if self.book.get("excite") is None:
            if self.options.model is not None:
                self._design(self.room, table, self._report)
            played = arm().play(load_leader(self.book.path(EXCITING)), path, table, patient=True, watched=False)
            if played.stopped:
                raise AnewError(f"the arm cannot be excited: {played.stopped}; narrow the --range.")
            self.book.note("excite", {"log": path.name})
        return read_evidence(path)

    def _try(self, arm: Callable[[], ArmOnPort], learnt: learn.LearntController) -> None:
        """Try a round's controllers on the arm; those that fail are searched again with what the arm showed."""
        trials, rows = self.trials, learnt.controllers
        hoped: list[float] = []
        for number in range(1, self.options.trials + 1):
            self.trying = f", trial {number} of {self.options.trials} at most"
            trial = trials.play(None if trials.known() else arm(), rows)
            self.tried = errors_beside(predict_trial(learnt.arm, trial, trials.check), trial)
            for one, row, verdict in zip(self.joints, rows, trial.verdicts, strict=True):
                if verdict.known:
                    one.add(row, verdict)
            hoped.append(sum(one.best.verdict.share * one.best.verdict.value for one in self.joints))
            failed = np.array([verdict.known and not verdict.passed for verdict in trial.verdicts])
            if not failed.any() or is_enough(hoped, self.options.judging.rounds) or number == self.options.trials:
                break
            self.on_model = self.on_model.corrected(trial)
            passed = np.array([verdict.passed for verdict in trial.verdicts])
            begin = np.where(passed[:, None], self._best_rows(), rows)
            rows = self._search_on_model(f"after-{trial.name}", begin, failed)
            if any(np.array_equal(rows, known.rows) for known in trials.done):
                break
        self.trying = ""

    def _best_rows(self) -> Controllers:
        """Every joint's best so far, of whatever trial."""
        rows = controllers_of(self.trials.table).copy()
        for joint, one in enumerate(self.joints):
            rows[joint] = one.best.row
        return rows

    def _needs_another_round(self) -> bool:
        """Whether another round may help: a joint follows little better than before."""
        return any(one.best.verdict.value > self.options.judging.rounds.max_error_share for one in self.joints)

    def _report(self, what: str, fraction: float, note: str = "") -> None:
        self.report(f"{self.stage}{self.trying}: {what}", fraction, note or self.tried)

    @contextmanager
    def _arm(self) -> Iterator[Callable[[], ArmOnPort]]:
        """The arm, connected when it is first asked for, and left with its motors off at the end."""
        with ExitStack() as stack:
            rigs: list[ArmOnPort] = []

            def arm() -> ArmOnPort:
                if not rigs:
                    rigs.append(stack.enter_context(connected(self.options.port, self.before, self._report)))
                return rigs[0]

            yield arm
