"""Each joint's controllers: what the arm said about them, and which is next where one was restless.

A set takes each joint's best, of whatever trial, but only where the round's model says that together they come to rest
after quick moves; else the cheapest set that does. At the end of a commissioning it is tried on the arm; where that is
worse, joints step back: first those that fail; where they have nothing else left, those beside them, which shake them.
A joint keeps what it had before only where its tuned controller was tried, too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import reduce

import numpy as np

from greywhale.base.types import Controllers, Integers
from greywhale.commission.arm_on_port import ArmOnPort
from greywhale.commission.judge import TrialVerdict
from greywhale.commission.trials import Trial, Trials
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.table import CONTROLLER_COLUMNS

Row = Integers  # (13,)
PricedRow = tuple[Row, float]  # a joint's controller, and what it adds to a set's cost
PE_B, KP, KI, KU = (CONTROLLER_COLUMNS.index(name) for name in ("pe_b", "kp", "ki", "ku_mv"))
ASKED_AT_ONCE = 16  # sets: so many are simulated side by side


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

    def priced(self) -> list[PricedRow]:
        """All that passed or can be borne, each once, the best first, with what it adds to a set's cost."""
        found: dict[bytes, PricedRow] = {}
        for one in self.ranked():
            found.setdefault(one.row.tobytes(), (one.row, one.verdict.share * one.verdict.ranking_cost))
        return list(found.values())

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


def combine(trials: Trials, joints: Sequence[Sequence[PricedRow]]) -> Controllers:
    """The cheapest set (4, 13) of one controller a joint that comes to rest after quick moves by the round's model; of
    all sets where none does. Each joint has its controllers and their costs, the first of equals preferred.
    """
    rows, costs = zip(*(zip(*one, strict=True) for one in joints), strict=True)
    totals = reduce(np.add.outer, costs).ravel()
    ranking = np.stack(np.unravel_index(np.argsort(totals, kind="stable"), [len(one) for one in costs]), axis=1)
    for first in range(0, len(ranking), ASKED_AT_ONCE):
        asked = ranking[first : first + ASKED_AT_ONCE]
        sets = np.array([[rows[joint][place] for joint, place in enumerate(one)] for one in asked], dtype=np.int32)
        rests = trials.come_to_rest(sets)
        if rests.any():
            found: Controllers = sets[int(np.argmax(rests))]
            return found
    return np.array([one[0] for one in rows], dtype=np.int32)


def combine_best(trials: Trials, joints: Sequence[JointTrials]) -> Controllers:
    """Every joint's best so far, of whatever trial, as far as they come to rest together."""
    return combine(trials, [one.priced() for one in joints])


def confirm(
    trials: Trials, joints: Sequence[JointTrials], connect: Callable[[], ArmOnPort], tuned: Controllers
) -> Trial:
    """The best set that was measured as a whole. A combination that was not measured is played before it counts."""
    before = controllers_of(trials.table)
    failed: list[list[bytes]] = [[] for _ in joints]

    def left(joint: int) -> list[PricedRow]:
        """A joint's controllers that have not failed in company; before that from before, the tuned one where it is
        untried.
        """
        one, known = joints[joint], before[joint].tobytes()
        priced = one.priced()
        last = next((pair for pair in priced if pair[0].tobytes() == known), (before[joint], np.inf))
        if not one.has_tried(tuned[joint]):
            better = [pair for pair in priced if pair[0].tobytes() != known]
            priced = [*better, (tuned[joint], last[1]), last]
        return [pair for pair in priced if pair[0].tobytes() not in failed[joint]] or [last]

    rows = combine(trials, [left(joint) for joint in range(len(joints))])
    for _ in range(trials.judging.rounds.max_confirmations):
        known = next((one for one in trials.done if np.array_equal(one.rows, rows)), None)
        trial = known or trials.play(connect, rows)
        if trial.passes_at_a_price:
            break
        failing = np.array([verdict.known and not verdict.passes_at_a_price for verdict in trial.verdicts])
        kept = (rows == before).all(axis=1)
        for back in (failing, ~failing & ~kept):
            for joint in np.flatnonzero(back).tolist():
                failed[joint].append(rows[joint].tobytes())
            stepped = combine(trials, [left(joint) for joint in range(len(joints))])
            if not np.array_equal(stepped, rows):
                rows = stepped
                break
        else:
            break
    return trials.ranked()[0]
