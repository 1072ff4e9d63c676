"""Finds one joint's model from records of it: global search, least squares, as many quantities as the records ask for.

Two residuals together, as in greywhale.identify: the joint inside its known controller along the whole record, and
under the logged voltages over windows. What a model gets wrong it gets wrong for many readings in a row, so a stretch
of CORRELATED_S counts as one observation of the size that the residual turns out to have, and what is known beforehand
(the rig's published data, usual values) as one observation more of each quantity. It decides what the record leaves
open.

A quantity stays in the model if with it blocks of the records are predicted better that were left out of the fit; every
block in turn, so that a short record is used up in full.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from greywhale.base.errors import BAD_USAGE, UserError
from greywhale.base.types import Floats
from greywhale.identify.fit import Fit, least_squares_fit, pick_different
from greywhale.optimise import minimise
from studies.one_joint.law import Law
from studies.one_joint.plant import JointSpace, Rig
from studies.one_joint.record import Record
from studies.one_joint.residual import JointResidual, Part, left_out, part_of

Report = Callable[[str, float], None]

MOTOR = ("alpha", "inertia", "damping")
FRICTION = (*MOTOR, "coulomb")
# What may be added to motor and Coulomb friction; the second says which rigs can show it.
EXTRAS: tuple[tuple[tuple[str, ...], Callable[[Rig], bool]], ...] = (
    (("delay",), lambda rig: True),
    (("leader_delay",), lambda rig: True),
    (("breakaway", "stribeck"), lambda rig: True),
    (("load_friction",), lambda rig: rig.weight > 0.0 or rig.loaded),
    (("pull",), lambda rig: rig.weight == 0.0),
    (("hanging",), lambda rig: rig.weight > 0.0 and not rig.zero_known),
    (("gap",), lambda rig: rig.link_inertia > 0.0),
)
WORTH = 0.02  # share by which a quantity must lower the error on what is left out
FIRST_SIZE = 0.02  # of an error before it is known, as a share of the joint's range
GLOBAL_EVALUATIONS = 300
GLOBAL_SPREAD = 2.5  # factors e^(+-2.5) around the rig's published data
STARTS = 2
STEPS = 15


@dataclass(frozen=True)
class Example:
    """Rows [begin, end) of a record to learn from, with the controller that made it (None: unknown)."""

    record: Record
    law: Law | None
    begin: int = 0
    end: int | None = None
    windows: bool = True  # False: only inside the controller

    @property
    def stop(self) -> int:
        return len(self.record.time) if self.end is None else self.end


@dataclass(frozen=True)
class JointModel:
    """A joint as found. `tried`: each set of quantities that was fitted, with its error on what was left out."""

    space: JointSpace
    x: Floats
    tried: tuple[tuple[tuple[str, ...], float], ...] = field(default=(), repr=False)

    @property
    def plant(self) -> Floats:
        """(1, 19)."""
        return self.space.plants(self.x[None])

    @property
    def values(self) -> dict[str, float]:
        return self.space.values(self.x)


@dataclass(frozen=True)
class _Found:
    """A set of quantities, fitted, and how well it predicts blocks of the records that are left out."""

    fit: Fit[JointSpace]
    score: float

    @property
    def space(self) -> JointSpace:
        return self.fit.space

    @property
    def x(self) -> Floats:
        return self.fit.x


class _Search:
    def __init__(self, rig: Rig, examples: Sequence[Example], seed: int, report: Report) -> None:
        if not examples:
            raise UserError("identification needs at least one record.", BAD_USAGE)
        self.rig, self.seed, self.report = rig, seed, report
        self.parts: list[Part] = []
        for number, one in enumerate(examples):
            ways = [one.law] if one.law is not None else []
            laws = [*ways, None] if one.windows or one.law is None else ways
            self.parts += [part_of(one.record, law, one.begin, one.stop, number, rig.window_s) for law in laws]
        moved = max(float(np.ptp(one.record.follower[one.begin : one.stop])) for one in examples)
        if moved <= 0.0:
            raise UserError("the joint rests in every record, which tells nothing of it; give one with motion.", 2)
        self.sizes = [FIRST_SIZE * moved] * len(self.parts)
        self.usual: Floats | None = None
        self.tried: list[tuple[tuple[str, ...], float]] = []

    def run(self) -> JointModel:
        motors = self.fit(JointSpace.of(self.rig, MOTOR), [])
        self.measure_sizes(motors)
        best = self._measured(FRICTION, motors.space, motors.x)
        self.measure_sizes(best.fit)
        grown = self._grown(best)
        every = [name for names in self._extras() for name in names]
        shrunk = self._shrunk(self._measured((*FRICTION, *every), grown.space, grown.x))
        best = min(grown, shrunk, key=lambda one: one.score)
        self.measure_sizes(best.fit)
        last = self.fit(best.space, [best.x])
        return JointModel(last.space, last.x, tuple(self.tried))

    def fit(self, space: JointSpace, known: Sequence[Floats]) -> Fit[JointSpace]:
        """Least squares from what is known and from the best points of a global search."""
        residual = JointResidual(self.parts, self.sizes)
        starts = [*known, *self._global(space, residual, known)]
        return min((least_squares_fit(residual, space, one, STEPS) for one in starts), key=lambda one: one.cost)

    def measure_sizes(self, fit: Fit[JointSpace]) -> None:
        self.sizes = [
            max(float(np.sqrt(np.mean(one.errors(fit.space.plants(fit.x[None])) ** 2))), 1e-6) for one in self.parts
        ]

    def _grown(self, best: _Found) -> _Found:
        """Add what lowers the error most, as long as it is worth it."""
        left = self._extras()
        while left:
            self.report("adding quantities", 1.0 - len(left) / len(self._extras()))
            found = [self._measured((*best.space.names, *names), best.space, best.x) for names in left]
            number = int(np.argmin([one.score for one in found]))
            if found[number].score > (1.0 - WORTH) * best.score:
                break
            best = found[number]
            self.measure_sizes(best.fit)
            del left[number]
        return best

    def _shrunk(self, best: _Found) -> _Found:
        """Leave out what can be done without, the most superfluous first."""
        left = self._extras()
        while left:
            self.report("leaving quantities out", 1.0 - len(left) / len(self._extras()))
            kept = [[name for name in best.space.names if name not in names] for names in left]
            found = [self._measured(names, best.space, best.x) for names in kept]
            number = int(np.argmin([one.score for one in found]))
            if (1.0 - WORTH) * found[number].score > best.score:
                break
            best = found[number]
            del left[number]
        return best

    def _extras(self) -> list[tuple[str, ...]]:
        return [names for names, shown in EXTRAS if shown(self.rig)]

    def _measured(self, names: Sequence[str], source: JointSpace, x: Floats) -> _Found:
        space = JointSpace.of(self.rig, names)
        fit = self.fit(space, [space.translate(x, source)])
        mse = left_out(fit, self.parts, self.sizes)
        if self.usual is None:
            self.usual = mse
        # Each way of running counts in proportion to what motor and Coulomb friction alone leave.
        score = float(np.mean(mse / self.usual))
        self.tried.append((space.names, score))
        return _Found(fit, score)

    def _global(self, space: JointSpace, residual: JointResidual, known: Sequence[Floats]) -> list[Floats]:
        """The best points of the default optimiser that differ."""
        middle = space.start()
        low, high = space.bounds()
        low, high = np.maximum(low, middle - GLOBAL_SPREAD), np.minimum(high, middle + GLOBAL_SPREAD)
        seen: list[tuple[float, Floats]] = []

        def cost(points: Floats) -> Floats:
            # Bounded per number, so that one stretch far off does not hide what the others gain.
            costs: Floats = np.mean(np.log1p(residual(space, points) ** 2), axis=1)
            seen.extend((float(one), point.copy()) for one, point in zip(costs, points, strict=True))
            return costs

        start = np.clip([middle, *known], low, high)
        minimise(cost, low, high, budget=GLOBAL_EVALUATIONS, seed=self.seed, start=start)
        return pick_different(seen, STARTS)


def identify_joint(
    rig: Rig, examples: Sequence[Example], *, seed: int = 0, report: Report = lambda what, share: None
) -> JointModel:
    """A model of the joint that made these records (at least one)."""
    return _Search(rig, examples, seed, report).run()


def fit_joint(rig: Rig, examples: Sequence[Example], names: Sequence[str], *, seed: int = 0) -> JointModel:
    """The same with the quantities given, not chosen."""
    search = _Search(rig, examples, seed, lambda what, share: None)
    first = search.fit(JointSpace.of(rig, names), [])
    search.measure_sizes(first)
    second = search.fit(first.space, [first.x])
    return JointModel(second.space, second.x)
