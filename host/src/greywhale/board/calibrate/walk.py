"""The sweeps and poses of a calibration, one after the other, and back again where the person wants to."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.board.calibrate.person import PersonAnswer, Watch
from greywhale.board.calibrate.rules import ask
from greywhale.board.calibrate.solve import Calibration, Pose, apart, match, slipped, solve
from greywhale.board.calibrate.sweep import Sweep, judge_sweep
from greywhale.board.calibrate.words import MEND, MEND_POSE, joint_name, sweep_asked
from greywhale.board.limits import CALIBRATION
from greywhale.board.pots import POTS, read_counts
from greywhale.board.refusal import upper_first
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.joints import Joints

_COUNTS = {2: "two", 4: "four", 6: "six", 8: "eight"}


class Walk:
    """The readings so far. `poses` are the four that are asked for; the second's angles count if `track_rad` is None,
    else the tracks have this length.
    """

    def __init__(self, watch: Watch, joints: Joints, poses: Sequence[tuple[Floats, str]], track_rad: float | None):
        self._watch = watch
        self._asked = poses
        self._track_rad = track_rad
        self._pots = [pot for pot in range(len(POTS)) if pot % JOINTS in joints]  # in the order of the sweeps
        self._sweeps: dict[int, Sweep] = {}
        self._poses: dict[int, Pose] = {}
        self._tries = Counter[str]()

    def go(self, at: int = 0) -> tuple[Calibration, Floats]:
        """The calibration, and how far the arms are apart (4,) rad in the last pose, from which nothing was worked out.

        Raises UserError with the mistakes found. A walk that was gone to its end may be gone again from a later step.
        """
        while at < self.length:
            pose = at - len(self._pots)
            answer = self._sweep(at) if pose < 0 else self._pose(pose)
            at = self._next(at, answer)
        return self._found(), self._compare()

    @property
    def length(self) -> int:
        return len(self._pots) + len(self._asked)

    def _next(self, at: int, answer: PersonAnswer) -> int:
        match answer:
            case PersonAnswer.BACK if at == 0:
                self._watch.guide.tell("This is the first step.")
            case PersonAnswer.BACK:
                return at - 1
            case PersonAnswer.SKIP if at < len(self._pots):
                self._pots.append(self._pots.pop(at))
            case PersonAnswer.SKIP:
                self._watch.guide.tell("A pose cannot wait.")
            case PersonAnswer.DONE:
                return at + 1
        return at

    def _sweep(self, at: int) -> PersonAnswer:
        pot, of = self._pots[at], len(self._pots)
        answer, counts = self._watch.ask(sweep_asked(pot, at + 1, of), [pot])
        if answer is not PersonAnswer.DONE:
            return answer
        sweep = judge_sweep(counts, pot)
        if sweep.mistakes:
            return self._mend(pot, " ".join(sweep.mistakes))
        self._sweeps[pot] = sweep
        if at + 1 == of:
            self._watch.guide.tell(f"All {_COUNTS[of]} potentiometers turn with their joints.")
        return answer

    def _mend(self, pot: int, mistakes: str) -> PersonAnswer:
        """Ask how to go on after a sweep with mistakes; what moves while a person mends is not judged."""
        name = upper_first(joint_name(pot))
        self._refuse(name, mistakes, mistakes)
        if not self._watch.guide.patient:
            return PersonAnswer.AGAIN
        answer, _ = self._watch.ask(f"{name}: {MEND}", [pot])
        return PersonAnswer.AGAIN if answer is PersonAnswer.DONE else answer

    def _pose(self, number: int) -> PersonAnswer:
        """Ask for a pose; both arms must be held still."""
        angles, what = self._asked[number]
        answer, _ = self._watch.ask(what, sorted(self._pots))
        if answer is not PersonAnswer.DONE:
            return answer
        counts = read_counts(self._watch.device, self._watch.table, CALIBRATION.held_ticks)
        means, moved = ask("held", counts)
        if moved:
            self._refuse(what, moved, "the arms were not held still; lay them on a support, and begin anew.")
            return PersonAnswer.AGAIN
        self._poses[number] = Pose(angles, means)
        try:
            self._check(number)
        except UserError as mistake:
            if not self._watch.guide.patient:
                raise
            sentence = mistake.message.removeprefix(f"{self._watch.device.port}: ")
            self._watch.guide.tell(f"{upper_first(sentence)} {MEND_POSE}")
            return PersonAnswer.AGAIN
        return answer

    def _refuse(self, step: str, mistake: str, at_last: str) -> None:
        """Tell a mistake; a script, which mends nothing, makes it but a few times."""
        self._tries[step] += 1
        if not self._watch.guide.patient and self._tries[step] == CALIBRATION.script_tries:
            raise UserError(f"{self._watch.device.port}: {at_last}")
        self._watch.guide.tell(mistake)

    def _check(self, number: int) -> None:
        """Raise UserError where the pose that was just held contradicts what was before."""
        if number == 1:
            self._found()
        if number == 2 and (moved := slipped(self._poses[0], self._poses[2])):
            raise UserError(f"{self._watch.device.port}: {moved}")
        if number == 3:
            self._compare()

    def _found(self) -> Calibration:
        sweeps, first, second = list(self._sweeps.values()), self._poses[0], self._poses[1]
        if self._track_rad is None:
            return solve(sweeps, first, second, None)
        return match(solve(sweeps, first, None, self._track_rad), sweeps, first, second)

    def _compare(self) -> Floats:
        """The distance between the arms (4,) rad in the last pose; those before fit by themselves."""
        distances, mistake = apart(self._found(), self._poses[3])
        if mistake:
            raise UserError(f"{self._watch.device.port}: {mistake}")
        return distances
