"""Trials on the arm: a set of controllers is led along the check, measured, and judged against those from before."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, TypedDict

import numpy as np

from greywhale.base.types import Controllers, Flags, PerJoint
from greywhale.commission.arm_on_port import ArmOnPort, PlayedMotion
from greywhale.commission.foresee import Foresight
from greywhale.commission.journal import AnewError, CommissioningJournal
from greywhale.commission.judge import Limits, TrialVerdict, judge
from greywhale.commission.limits import COMMISSIONING_LIMITS, CommissioningLimits
from greywhale.commission.measures import Measures, PartFacts, measure, traces_of
from greywhale.commission.motions import Check
from greywhale.files.log import read_evidence
from greywhale.loop.controllers import controllers_of
from greywhale.loop.traces import Traces
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import CONTROLLER_COLUMNS, ParameterTable

BEFORE = "before"
GAINS = [CONTROLLER_COLUMNS.index(name) for name in ("ki", "ku_mv")]
_COLUMNS = len(CONTROLLER_COLUMNS)


class TrialFacts(TypedDict):
    trial: str  # its name
    log: str  # in the folder
    controllers: PerJoint[Annotated[list[int], ("minItems", _COLUMNS), ("maxItems", _COLUMNS)]]  # raw, as stored
    stopped: str  # why, or empty
    passed: bool  # whether all joints did, with each other
    faults: PerJoint[list[str]]
    score: PerJoint[float | None]  # against before; below 1 is better
    measured: dict[str, PartFacts]  # a part of the check each


@dataclass(frozen=True)
class Trial:
    """Controllers (4, 13) that ran on the arm, their log, and what was measured. `stopped` says why it ended early.

    `table` is the whole set that the board ran.
    """

    name: str
    rows: Controllers
    table: ParameterTable = field(repr=False)
    path: Path
    stopped: str
    measured: Measures
    verdicts: tuple[TrialVerdict, ...]
    traces: Traces = field(repr=False)

    @property
    def whole(self) -> bool:
        """True where the check was played to its end."""
        return not self.stopped and self.measured.whole

    @property
    def passed(self) -> bool:
        """True where all joints passed, with each other, to the end of the check."""
        return self.whole and all(verdict.passed for verdict in self.verdicts)

    @property
    def passes_at_a_price(self) -> bool:
        """True where all joints passed to the end of the check, or are a little restless and have no other fault."""
        return self.whole and all(verdict.passes_at_a_price for verdict in self.verdicts)

    @property
    def score(self) -> float:
        """The error of all joints together in what a hand leads, relative to before."""
        return sum(verdict.share * verdict.score for verdict in self.verdicts)

    @property
    def ranking_cost(self) -> float:
        """The score, with a price on what has to be borne; less is better."""
        return sum(verdict.share * verdict.ranking_cost for verdict in self.verdicts)

    def as_dict(self) -> TrialFacts:
        return {
            "trial": self.name,
            "log": self.path.name,
            "controllers": self.rows.tolist(),
            "stopped": self.stopped,
            "passed": self.passed,
            "faults": [list(verdict.faults) for verdict in self.verdicts],
            "score": [None if np.isnan(verdict.score) else round(verdict.score, 4) for verdict in self.verdicts],
            "measured": self.measured.as_dict(),
        }


class Trials:
    """All trials so far. The first is that of the controllers from before, against which the others are judged."""

    def __init__(
        self,
        journal: CommissioningJournal,
        check: Check,
        before: ParameterTable,
        judging: CommissioningLimits = COMMISSIONING_LIMITS,
    ) -> None:
        self.journal = journal
        self.judging = judging
        self.check = check
        self.stored = before  # by the board
        self.table = before  # the same, with the softer controllers of joints that swung
        self.done: list[Trial] = []
        self.softened: list[int] = []  # joints whose controller from before was halved, in that order
        self.foresight: Foresight | None = None  # of the model of this round
        self.others: dict[str, int] = {}  # raw, what the model says besides controllers, for the trials to come
        while (facts := journal.get(self._next_softening)) is not None:
            self._halve(facts["joint"])

    @property
    def before(self) -> Trial:
        return self.done[0]

    def table_of(self, rows: Controllers) -> ParameterTable:
        """The board's table with these controllers, for a trial to come."""
        return self.table.with_controllers(rows).with_raw(self.others)

    @property
    def _next_softening(self) -> str:
        return f"softer-{len(self.softened) + 1}"

    def _halve(self, joint: int) -> None:
        rows = controllers_of(self.table).copy()
        rows[joint, GAINS] //= 2
        self.table = self.table.with_controllers(rows)
        self.softened.append(joint)

    def soften(self, played: PlayedMotion, refusal: str) -> None:
        """Halve the voltage and the integral of the joint that swung, in what counts as before from now on. Raises
        AnewError with the refusal where a joint did not swing, or swings however soft it is.
        """
        joint, most = played.joint, self.judging.motion.softer_starts
        if joint is None or not played.swung or self.softened.count(joint) >= most:
            raise AnewError(refusal)
        self.journal.note(self._next_softening, {"joint": joint})
        self._halve(joint)

    def play_before(self, connect: Callable[[], ArmOnPort]) -> Trial:
        """Play the check with the controllers from before; see `play` and `soften`."""
        trial, played = self._tried(connect, controllers_of(self.table), watched=False)
        while trial.stopped:
            self.done.clear()
            self.soften(
                played,
                f"with the controllers from before, the check ended early: {trial.stopped}; narrow the --range, or "
                "upload calmer controllers first.",
            )
            trial, played = self._tried(connect, controllers_of(self.table), watched=False)
        if not trial.measured.whole:
            raise AnewError(
                "the check with the controllers from before cannot be measured, because this computer was late with "
                "its motion; close other programs, and begin anew."
            )
        return trial

    def play(self, connect: Callable[[], ArmOnPort], rows: Controllers) -> Trial:
        """Play the check with these controllers on the arm; where the journal has that trial, without connecting it."""
        return self._tried(connect, rows, watched=True)[0]

    def _tried(self, connect: Callable[[], ArmOnPort], rows: Controllers, watched: bool) -> tuple[Trial, PlayedMotion]:
        name = self._next_name()
        path, played = self._played(name, connect, rows, watched)
        trial = self._judged(name, rows, path, played)
        self.done.append(trial)
        return trial, played

    def _played(
        self, name: str, connect: Callable[[], ArmOnPort], rows: Controllers, watched: bool
    ) -> tuple[Path, PlayedMotion]:
        """A log and how it ended. The controllers from before may hunt already: unwatched, they do so to the end."""
        path = self.journal.path(f"{name}.csv")
        facts = self.journal.get(name)
        if facts is not None:
            if facts["controllers"] != rows.tolist():
                raise AnewError(
                    f"{self.journal.folder}: {name} of this commissioning was made by another version of greywhale, "
                    "which would go on differently; begin anew in another folder."
                )
            return path, PlayedMotion(read_evidence(path), facts["stopped"], facts["joint"])
        played = connect().play(self.check.motion, path, self.table_of(rows), watched=watched)
        if self.done or not played.stopped:  # else it is made again, with softer controllers
            self.journal.note(name, {"controllers": rows.tolist(), "stopped": played.stopped, "joint": played.joint})
        return path, played

    def come_to_rest(self, sets: Controllers) -> Flags:
        """(n,) of sets (n, 4, 13): whether all joints come to rest after quick moves, by the round's model if any."""
        if self.foresight is None:
            return np.ones(len(sets), dtype=bool)
        found: Flags = (self.foresight.beyond_rest(sets) == 0.0).all(axis=1)
        return found

    def ranked(self) -> list[Trial]:
        """Sets of controllers that can be borne as a whole and come to rest, the best first; those from before always
        count.
        """
        whole = [one for one in self.done[1:] if one.passes_at_a_price and self.come_to_rest(one.rows[None])[0]]
        return sorted([*whole, self.before], key=lambda one: one.ranking_cost)

    def _next_name(self) -> str:
        return f"trial-{len(self.done):02d}" if self.done else BEFORE

    def _judged(self, name: str, rows: Controllers, path: Path, played: PlayedMotion) -> Trial:
        traces = traces_of(played.log, self.check)
        measured = measure(traces, self.check, self.table.supply_v)
        before = self.before.measured if self.done else measured
        guilty = [played.stopped if joint == played.joint else "" for joint in range(JOINTS)]
        kept = (rows == controllers_of(self.table)).all(axis=1)
        foreseen = ("",) * JOINTS if self.foresight is None else self.foresight.clauses(rows)
        quiet_v = self.judging.swings.bounds.quiet_share * self.table.supply_v
        limits = Limits.of(before, kept, quiet_v, self.judging)
        verdicts = judge(measured, before, limits, guilty, foreseen, self.judging)
        return Trial(name, rows.copy(), self.table_of(rows), path, played.stopped, measured, verdicts, traces)
