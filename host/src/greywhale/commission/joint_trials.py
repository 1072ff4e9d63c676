"""One joint's controllers as the arm judged them, beside whatever the other joints ran."""

from __future__ import annotations

from dataclasses import dataclass, field

from greywhale.base.types import Integers
from greywhale.commission.judge import TrialVerdict

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
        return sorted((one for one in self.tried if one.verdict.bearable), key=lambda one: one.verdict.value)

    def add(self, row: Row, verdict: TrialVerdict) -> None:
        """Note a judged controller."""
        self.tried.append(TriedController(row.copy(), verdict))
