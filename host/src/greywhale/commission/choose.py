"""The end of a commissioning: each joint's best, tried together on the arm; where that is worse, joints step back.

First those that fail; where they have nothing else left, those beside them, which shake them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from greywhale.base.types import Integers
from greywhale.commission.arm_on_port import ArmOnPort
from greywhale.commission.judge import TrialVerdict
from greywhale.commission.trials import Trial, Trials
from greywhale.loop.controllers import controllers_of

Row = Integers  # (13,)


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


def confirm(trials: Trials, joints: Sequence[JointTrials], connect: Callable[[], ArmOnPort]) -> Trial:
    """The best set that was measured as a whole. A combination that was not measured is played before it counts."""
    before = controllers_of(trials.table)
    failed: list[list[bytes]] = [[] for _ in joints]

    def best(joint: int) -> Row:
        """A joint's best that has not failed in company."""
        left = (one.row for one in joints[joint].ranked() if one.row.tobytes() not in failed[joint])
        return next(left, before[joint])

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
