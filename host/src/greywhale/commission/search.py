"""The search on the arm itself, joint by joint: a restless controller gets softer, any other is varied step by step.

A model tells where to begin. What it does not know (play, a slow wiper) shows in measures on the arm only, and mostly
asks for the same: less gain, more damping, another integral part.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from greywhale.commission.judge import TrialVerdict
from greywhale.fuzzy.settings import GAIN_UNIT
from greywhale.protocol import schema
from greywhale.simulate import CONTROLLER_COLUMNS
from greywhale.tune.search.space import largest_ki

Row = npt.NDArray[np.int32]

KP, KD, KI = (CONTROLLER_COLUMNS.index(name) for name in ("kp", "kd", "ki"))
# A restless joint gets less stiffness, relatively more damping, and hardly any integral part that could hunt; one that
# only chatters gets less damping.
SOFTER = {KP: 0.5, KD: 0.8, KI: 0.1}
FIRST_SOFTER = {KP: 0.5, KD: 1.2, KI: 0.1}
QUIETER = {KD: 0.6}
MOST_SOFTER = 3
# From so many times its limit on, the step is whole; for less it is a part of it, as a power, but never less than this.
FAR, GENTLY = 4.0, 0.35
# The steps of the search: stiffer, more integral part against friction, more damping, softer, less integral part.
STEPS: tuple[dict[int, float], ...] = ({KP: 1.8, KD: 1.45}, {KI: 6.0}, {KD: 1.4}, {KP: 0.7}, {KI: 0.15})
# A step that follows better, but is restless by less than so many times, is made again half as far, at most twice.
HARDLY, HALF, HALVES = 2.5, 0.5, 2
LEAST_KI, MOST_KI = 30.0, 300.0  # V/(rad s), where a step enlarges it; less does next to nothing in a move


@dataclass(frozen=True)
class TriedController:
    """A joint's controller (12,) and what the arm said about it; `trial` is where that was measured."""

    row: Row
    verdict: TrialVerdict
    trial: str


def _rank(one: TriedController) -> tuple[bool, float]:
    """What can be borne comes first, then what follows best; a joint that another one stopped has no score."""
    score = one.verdict.value if one.verdict.bearable else one.verdict.score
    return not one.verdict.bearable, score if np.isfinite(score) else np.inf


@dataclass
class JointSearch:
    """One joint's controllers in the order of their trials."""

    joint: int
    period_ms: int
    tried: list[TriedController] = field(default_factory=list)
    _softened: int = 0
    _step: int = 0
    _from: Row | None = None
    _factors: dict[int, float] | None = None  # of the step that is on trial
    _halved: int = 0  # how often that step was made again half as far

    @property
    def best(self) -> TriedController:
        """The best that passed or can be borne, as the controller from before always can."""
        return self.ranked()[0]

    def ranked(self) -> list[TriedController]:
        """All that passed or can be borne, the best first."""
        return sorted((one for one in self.tried if one.verdict.bearable), key=_rank)

    def add(self, row: Row, verdict: TrialVerdict, trial: str) -> None:
        """Note a judged controller."""
        self.tried.append(TriedController(row.copy(), verdict, trial))

    def propose(self, promises: Callable[[Row], bool] = lambda row: True) -> Row | None:
        """The next controller to try; None where there is nothing left to vary.

        Of the steps of the search, those that promise nothing are left out; a restless joint gets softer in any case.
        """
        if self.tried and self.tried[-1].verdict.restless and self._softened < MOST_SOFTER:
            softer = self._soften(self.tried[-1])
            if softer is not None:
                return softer
        self._softened = MOST_SOFTER
        calm = [one for one in self.tried if one.verdict.bearable or not one.verdict.restless]
        if not calm:
            return None
        centre = min(calm, key=_rank)
        halved = self._halve(centre)
        if halved is not None and self._is_new(halved) and promises(halved):
            return halved
        if self._from is None or not np.array_equal(self._from, centre.row):
            if self._from is not None and self._halved == 0:
                # What helped once may help twice, but not what helped only half as far.
                self._step = max(0, self._step - 1)
            self._from = centre.row
        while self._step < len(STEPS):
            self._factors, self._halved = STEPS[self._step], 0
            row = self._scaled(centre.row, self._factors)
            self._step += 1
            if row is not None and self._is_new(row) and promises(row):
                return row
        return None

    def soften(self, row: Row, verdict: TrialVerdict, trial: str) -> Row | None:
        """Note that a controller is restless beside the others' best; a softer one, None where nothing changes."""
        self.add(row, verdict, trial)
        self._softened = 0
        return self._soften(self.tried[-1])

    def begin(self) -> None:
        """A new controller of a model comes next: if it is restless, it is softened first."""
        self._softened = 0
        self._from = None
        self._factors = None
        self._step = 0

    def _is_new(self, row: Row) -> bool:
        return not any(np.array_equal(row, one.row) for one in self.tried)

    def _halve(self, centre: TriedController) -> Row | None:
        """The last step from `centre`, half as far: where it follows better, but is hardly too much."""
        last, factors = self.tried[-1].verdict, self._factors
        helps = last.restless and last.excess <= HARDLY and last.score < centre.verdict.score
        if factors is None or self._halved == HALVES or not helps:
            return None
        self._halved += 1
        self._factors = {column: factor**HALF for column, factor in factors.items()}
        return self._scaled(centre.row, self._factors)

    def _soften(self, last: TriedController) -> Row | None:
        factors = FIRST_SOFTER if self._softened == 0 else SOFTER
        if last.verdict.chatters_only:
            factors = QUIETER
        part = float(np.clip(np.log(last.verdict.excess) / np.log(FAR), GENTLY, 1.0))
        factors = {column: factor**part for column, factor in factors.items()}
        self._softened += 1
        return self._scaled(last.row, factors)

    def _scaled(self, row: Row, factors: dict[int, float]) -> Row | None:
        """The row with some gains multiplied, within what the firmware takes; None where that changes nothing."""
        changed = row.astype(np.float64)
        for column, factor in factors.items():
            changed[column] *= factor
            if column == KI and factor > 1.0:
                if row[KI] >= MOST_KI * GAIN_UNIT:
                    return None
                changed[KI] = np.clip(changed[KI], LEAST_KI * GAIN_UNIT, MOST_KI * GAIN_UNIT)
        most = {KI: largest_ki(self.period_ms) * GAIN_UNIT}
        for column in (KP, KD, KI):
            parameter = schema.PARAMETER_BY_NAME[f"joint0.{CONTROLLER_COLUMNS[column]}"]
            highest = min(float(parameter.maximum), most.get(column, np.inf))
            changed[column] = np.clip(changed[column], max(parameter.minimum, 1), highest)
        rounded = np.rint(changed).astype(np.int32)
        return None if np.array_equal(rounded, row) else rounded
