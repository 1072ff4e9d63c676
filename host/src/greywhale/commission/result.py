"""The outcome of a commissioning: rounds, trials, and what the board runs now."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TypedDict

import numpy as np

from greywhale.arm.parameters import JOINT_NAMES, ArmParameters
from greywhale.base.errors import counted
from greywhale.base.telling import Column, Motions, Part, Row, Sentences, Table, Telling
from greywhale.base.types import Crc, PerJoint
from greywhale.commission.learn import LearntController
from greywhale.commission.measures import Measures, PartFacts, measure
from greywhale.commission.motions import PARTS, Check
from greywhale.commission.trials import Trial, TrialFacts, Trials
from greywhale.loop.led_model import predict
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import ParameterTable


class RoundFacts(TypedDict):
    round: int  # counted from 1
    doubts: list[str]  # about the round's model
    margins_hold: bool  # those of its tuned controllers on its model, wherever they held before
    trials: list[str]  # their names


class ForeseenFacts(TrialFacts):
    predicted: dict[str, PartFacts]  # by the round's model


class CommissioningFacts(TypedDict):
    improved: bool  # whether the board ends with other controllers than before
    softened: PerJoint[int]  # how often a joint's voltage was halved for its trial "before": else it swung till stopped
    best: str  # name of the trial that the board ends with
    score: float  # what it leaves of the error from before in what a hand leads, all joints together
    tuned_score: float | None  # the same of the first round's tuned set, before the search on the model
    tuned_measured: bool  # whether the arm showed that, joint by joint, and not the model
    parameter_crc: Crc
    rounds: list[RoundFacts]
    trials: list[ForeseenFacts]  # those from before first


class CommissionAnswer(CommissioningFacts):
    port: str  # the serial port that was used
    report: str  # the page


@dataclass(frozen=True)
class Round:
    """One model, the controllers tuned on it, and the trials that followed."""

    number: int
    learnt: LearntController
    trials: tuple[Trial, ...]


@dataclass(frozen=True)
class TunedSet:
    """The error in what a hand leads that is left with a round's tuned set, before the search on the model.

    `measured` says whether every joint's tuned controller was played to the end, beside whatever others.
    """

    score: float
    measured: bool
    hunted: tuple[int, ...]  # joints that hunted with it


def predict_trial(arm: ArmParameters, trial: Trial, check: Check) -> Measures:
    """Predict the measures of a trial with a model."""
    return measure(predict(arm, trial.table, trial.traces)[0], check, trial.table.supply_v)


def errors_beside(predicted: Measures, trial: Trial) -> str:
    """The error over the joints in use and the parts played, as a model predicted it and as the arm made it."""
    joints = list(trial.table.joints_in_use)
    known = np.isfinite(predicted.error[:, joints]) & np.isfinite(trial.measured.error[:, joints])
    if not known.any():
        return f"{trial.name}: {trial.stopped}"
    shown, seen = (1e3 * np.sqrt(one.error[:, joints][known].mean()) for one in (predicted, trial.measured))
    return f"{trial.name}: error {shown:.1f} mrad rms predicted, {seen:.1f} measured"


@dataclass(frozen=True)
class CommissioningResult:
    """All trials of a commissioning, and the `best` of them. The board runs and stores its set where that is another
    than before.
    """

    trials: Trials
    rounds: tuple[Round, ...]
    best: Trial
    _predicted: dict[tuple[str, int], Measures] = field(default_factory=dict, init=False, repr=False, compare=False)

    @property
    def improved(self) -> bool:
        return self.best is not self.trials.before

    @property
    def table(self) -> ParameterTable:
        """The set that the board runs and stores now."""
        return self.best.table if self.improved else self.trials.stored

    def predicted(self, trial: Trial, round_: Round) -> Measures:
        """Predict the measures of a trial with a round's model; asked once, and told to all."""
        key = trial.name, round_.number
        if key not in self._predicted:
            self._predicted[key] = predict_trial(round_.learnt.arm, trial, self.trials.check)
        return self._predicted[key]

    def round_of(self, trial: Trial) -> Round:
        """The round that a trial belongs to; the last one's model is asked about what belongs to none."""
        return next((one for one in self.rounds if any(trial is done for done in one.trials)), self.rounds[-1])

    def as_dict(self) -> CommissioningFacts:
        tuned = self.tuned
        return {
            "improved": self.improved,
            "softened": [self.trials.softened.count(joint) for joint in range(JOINTS)],
            "best": self.best.name,
            "score": round(self.best.score, 4),
            "tuned_score": None if tuned is None else round(tuned.score, 4),
            "tuned_measured": tuned is not None and tuned.measured,
            "parameter_crc": f"0x{self.table.crc:04x}",
            "rounds": [
                {
                    "round": one.number,
                    "doubts": list(one.learnt.doubts),
                    "margins_hold": one.learnt.steady,
                    "trials": [trial.name for trial in one.trials],
                }
                for one in self.rounds
            ],
            "trials": [
                {**trial.as_dict(), "predicted": self.predicted(trial, self.round_of(trial)).as_dict()}
                for trial in self.trials.done
            ],
        }

    @property
    def tuned(self) -> TunedSet | None:
        """The first round's tuned set; None where there was no round."""
        if not self.rounds:
            return None
        learnt = self.rounds[0].learnt
        scores, hunted, measured = learnt.promised[0].copy(), [], True
        for joint in self.trials.table.joints_in_use:
            tried = [one for one in self.trials.done[1:] if (one.rows[joint] == learnt.tuned[joint]).all()]
            hunted += [joint] if any(one.verdicts[joint].hunts for one in tried) else []
            played = [one for one in tried if one.whole]
            measured &= bool(played)
            if played:
                most = max(played, key=lambda one: int((one.rows == learnt.tuned).all(axis=1).sum()))
                scores[joint] = most.verdicts[joint].score
        shares = np.array([verdict.share for verdict in self.trials.before.verdicts])
        return TunedSet(float((shares * np.nan_to_num(scores)).sum()), measured, tuple(hunted))

    @property
    def headline(self) -> str:
        """A sentence that names the set that the board runs now, and the joints that kept their controllers."""
        if not self.improved:
            return "No set passed on every joint: the controllers from before stay on the board."
        kept = [f"joint {joint} ({JOINT_NAMES[joint]})" for joint in self._kept]
        rest = f"; {' and '.join(kept)} kept the controller from before, since nothing better was found" if kept else ""
        return f"The board now runs and stores {self.best.name}{rest}."

    @property
    def _kept(self) -> list[int]:
        """Joints in use whose controller is the one from before."""
        same = (self.best.rows == self.trials.before.rows).all(axis=1)
        return [joint for joint in self.trials.table.joints_in_use if same[joint]]

    def tell(self) -> list[Part]:
        """The result for people: the set that the board has, and what changed on the arm, joint by joint."""
        played = len(self.trials.done) - 1
        tried = f"{counted(played, 'set')} of controllers tried on the arm in {counted(len(self.rounds), 'round')}."
        return [
            Sentences([self.headline, tried, *self._tell_softened(), *self._tell_tuned()]),
            *(self._tell_changes() if self.improved else ()),
        ]

    def text(self) -> str:
        return Telling(self.tell()).text()

    def _tell_softened(self) -> Iterator[str]:
        for joint in sorted(set(self.trials.softened)):
            share = 2 ** self.trials.softened.count(joint)
            yield (
                f"With its controller from before joint {joint} ({JOINT_NAMES[joint]}) swung until the board stopped "
                f'it; with 1/{share} of that voltage it was measured, and that is what "before" means here.'
            )

    def _tell_tuned(self) -> Iterator[str]:
        """The score beside that of the tuned set, which a commissioning is to beat."""
        tuned = self.tuned
        if tuned is not None and self.trials.before.measured.whole:
            told = "on the arm" if tuned.measured else "by the model"
            hunted = "".join(f"; joint {joint} ({JOINT_NAMES[joint]}) hunted with it" for joint in tuned.hunted)
            yield (
                f"Of the error from before in what a hand leads, {100.0 * self.best.score:.1f} % is left now. "
                f"The tuned set alone leaves {100.0 * tuned.score:.1f} % {told}{hunted}."
            )

    def _tell_changes(self) -> Iterator[Part]:
        before, after = self.trials.before.measured, self.best.measured
        joints = self.trials.table.joints_in_use
        columns = (
            Column("", width=14, left=True),
            *(Column(f"joint {one}\n{JOINT_NAMES[one]}", width=15) for one in joints),
        )
        pairs = [(part, before.error[place] ** 0.5, after.error[place] ** 0.5) for place, part in enumerate(PARTS)]
        pairs.append(("unrest at rest", before.worst("unrest"), after.worst("unrest")))
        errors = [
            Row((name, *(f"{1e3 * was[joint]:.1f} -> {1e3 * now[joint]:.1f}" for joint in joints)))
            for name, was, now in pairs
        ]
        yield Sentences(["On the arm (mrad rms), before -> after: the error in each part, and the unrest."])
        yield Table(columns, errors)
        yield Sentences(
            [
                "In the moves: overshoot (% of the step), and settling time to within 5 % (s).",
                "At rest: the voltage above 20 Hz, which one hears (V rms).",
            ]
        )
        rest = []
        for name, form in (("overshoot", ".0f"), ("settling", ".2f"), ("ripple", ".2f")):
            was, now = before.worst(name), after.worst(name)
            cells = (f"{number_text(was[joint], form)} -> {number_text(now[joint], form)}" for joint in joints)
            rest.append(Row((name, *cells)))
        yield Table(columns, rest)
        notes = [
            f"Joint {joint} ({JOINT_NAMES[joint]}): {fault}. No quieter controller follows as well."
            for joint in joints
            for fault in self.best.verdicts[joint].faults
        ]
        yield Sentences(notes, grave=True)
        yield Motions({"before": str(self.trials.before.path), "now on the board": str(self.best.path)}, near=False)


def number_text(value: float, form: str) -> str:
    return "-" if np.isnan(value) else f"{value:{form}}"
