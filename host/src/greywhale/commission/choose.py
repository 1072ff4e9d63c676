"""Each joint's controllers: what the arm said about them, and which is next where one was restless.

At the end of a commissioning each joint's best are tried together on the arm; where that is worse, joints step back:
first those that fail; where they have nothing else left, those beside them, which shake them. A joint keeps what it had
before only where its tuned controller was tried, too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from greywhale.base.types import Controllers, Integers
from greywhale.commission.arm_on_port import ArmOnPort
from greywhale.commission.judge import TrialVerdict
from greywhale.commission.trials import Trial, Trials
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.table import CONTROLLER_COLUMNS

Row = Integers  # (13,)
PE_B, KP, KI, KU = (CONTROLLER_COLUMNS.index(name) for name in ("pe_b", "kp", "ki", "ku_mv"))


@dataclass(frozen=True)
class TriedController:
    """A joint's controller (13,) and what the arm said about it."""

    row: Row
    verdict: TrialVerdict


@dataclass
class JointTrials:
    """One joint's controllers in the order of their trials."""

    tried: list[TriedController] = field(default_factory=list)

    @property
    def best(self) -> TriedController:
        """The best that passed or can be borne, as the controller from before always can."""
        return self.ranked()[0]

    def ranked(self) -> list[TriedController]:
        """All that passed or can be borne, the best first."""
        passed = (one for one in self.tried if one.verdict.passes_at_a_price)
        return sorted(passed, key=lambda one: one.verdict.ranking_cost)

    def add(self, row: Row, verdict: TrialVerdict) -> None:
        """Note a judged controller."""
        self.tried.append(TriedController(row.copy(), verdict))

    def has_tried(self, row: Row) -> bool:
        """True where the arm said something about this controller."""
        return any(np.array_equal(one.row, row) for one in self.tried)

    @property
    def restless(self) -> list[Row]:
        """The controllers with which the joint hunted, rattled, chattered or hissed, or ended a trial."""
        return [one.row for one in self.tried if one.verdict.restless]

    def calmer(self, tuned: Row, shares: Sequence[float]) -> Row:
        """On the way from the controller before to the tuned one, the first at one of these shares of it that is
        untried and softer than all restless ones; where none is, the one from before.
        """
        before, restless = self.tried[0].row, self.restless
        for share in shares:
            row: Row = np.rint(before + share * (tuned - before)).astype(np.int32)
            row[KI] = min([row[KI], *(one[KI] for one in restless)])
            if all(_stiffness(row) < _stiffness(one) for one in restless) and not self.has_tried(row):
                return row
        return before


def _stiffness(row: Row) -> float:
    """The volts for a small error, in a unit of its own."""
    return float(row[KU]) * float(row[KP]) / float(row[PE_B])


def confirm(
    trials: Trials, joints: Sequence[JointTrials], connect: Callable[[], ArmOnPort], tuned: Controllers
) -> Trial:
    """The best set that was measured as a whole. A combination that was not measured is played before it counts."""
    before = controllers_of(trials.table)
    failed: list[list[bytes]] = [[] for _ in joints]

    def best(joint: int) -> Row:
        """A joint's best that has not failed in company; before that from before, the tuned one where it is untried."""
        one, known = joints[joint], before[joint].tobytes()
        left = [tried.row for tried in one.ranked()]
        if not one.has_tried(tuned[joint]):
            better = [row for row in left if row.tobytes() != known]
            left = [*better, tuned[joint], before[joint]]
        return next((row for row in left if row.tobytes() not in failed[joint]), before[joint])

    rows = np.array([best(joint) for joint in range(len(joints))])
    for _ in range(trials.judging.rounds.max_confirmations):
        known = next((one for one in trials.done if np.array_equal(one.rows, rows)), None)
        trial = known or trials.play(connect, rows)
        if trial.passes_at_a_price:
            break
        failing = np.array([verdict.known and not verdict.passes_at_a_price for verdict in trial.verdicts])
        kept = (rows == before).all(axis=1)
        for back in (failing, ~failing & ~kept):
            stepped = rows.copy()
            for joint in np.flatnonzero(back).tolist():
                failed[joint].append(rows[joint].tobytes())
                stepped[joint] = best(joint)
            if not np.array_equal(stepped, rows):
                rows = stepped
                break
        else:
            break
    return trials.ranked()[0]
