"""The default method: a global search seeded with the user's arm, least squares, then as many quantities as held-out
data ask for.

1. GWO-WOA over motors and Coulomb friction, on some windows of the log under its logged voltages.
2. Least squares from the user's arm and from the best different points of that search; the best of them goes on.
3. One quantity after the other is added: Stribeck friction, backlash, zero angles. Each is fitted to three quarters
   of the log, spread all over it, under the logged voltages or (where the controller is known) in the closed loop, and
   stays only if the other quarter is predicted better with it.
4. What was chosen is fitted to the whole log.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from greywhale.arm import ArmParameters
from greywhale.identify.closed_loop import Loop, LoopResidual
from greywhale.identify.data import Prepared
from greywhale.identify.fit import Fit, Residual, least_squares_fit
from greywhale.identify.space import MOTOR, Space
from greywhale.identify.windows import WindowResidual
from greywhale.optimise import DEFAULT, create

Floats = NDArray[np.float64]
Report = Callable[[str, float], None]

# What each order of the model adds to the one before.
ORDERS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("motors", MOTOR),
    ("Coulomb friction", ("coulomb",)),
    ("Stribeck friction", ("breakaway", "stribeck")),
    ("backlash", ("gap",)),
    ("zero angles", ("offset",)),
)
# An order with more quantities must predict the held-out data better by this share.
WORTH = 0.02
# A closed-loop difference of this size counts as one standard deviation (rad).
LOOP_DOUBT = 2e-3
GLOBAL_EVALUATIONS = 500
GLOBAL_WINDOWS = 12
GLOBAL_SPREAD = 2.5  # the box of the global search: factors e^(+-2.5) around the user's arm
STARTS = 2  # of the global search's points that least squares starts from, beside the user's arm
WINDOW_STEPS = 12
LOOP_STEPS = 10
# Readings come in steps, so finite differences in the closed loop are taken wider than in the windows.
LOOP_STEP_SCALE = 5.0


@dataclass(frozen=True)
class Candidate:
    """A model on its way; `held_out` is its error on data it was not fitted to, None before it was measured."""

    space: Space
    x: Floats
    order: str
    held_out: float | None = None


@dataclass
class Search:
    """Everything found so far, so that whoever interrupts the search loses nothing but the rest of it."""

    arm: ArmParameters
    logs: Sequence[Prepared]
    loops: Sequence[Loop]  # of the same logs; empty where no controller is known
    joints: Sequence[int]
    seed: int
    report: Report
    best: Candidate | None = None
    tried: list[Candidate] = field(default_factory=list)
    simulations: int = 0
    globally: int = 0
    complete: bool = False

    def run(self) -> None:
        self._consider(self._refined(self._start()))
        self._consider(self._refined(self._with_friction()))
        for number in range(2, len(ORDERS)):
            self.report("choosing the model's order", (number - 2) / (len(ORDERS) - 2))
            assert self.best is not None
            if ORDERS[number][0] != "Stribeck friction" or self.best.order != "motors":
                self._consider(self._refined(self._with(self.best, number)))
        self._whole()

    def _consider(self, candidate: Candidate) -> None:
        measured = self._held_out(candidate)
        self.tried.append(measured)
        if self._better(measured):
            self.best = measured

    def _start(self) -> Candidate:
        """Motors alone, as the user has them, fitted to the windows."""
        space = Space.of(self.arm, MOTOR, self.joints)
        return Candidate(space, space.start(), ORDERS[0][0])

    def _with_friction(self) -> Candidate:
        """Global search, then least squares from several points; the best by the fitted data."""
        space = Space.of(self.arm, (*MOTOR, "coulomb"), self.joints)
        motors = self.tried[0]
        starts = [space.start(), space.moved(motors.x, motors.space), *self._global(space)]
        residual = self._prior(self._some_windows())
        fits = []
        for number, point in enumerate(starts):
            self.report("least squares from several starts", number / len(starts))
            fits.append(self._fit(residual, space, point, WINDOW_STEPS))
        chosen = min(fits, key=lambda one: one.cost)
        return Candidate(space, chosen.x, ORDERS[1][0])

    def _global(self, space: Space) -> list[Floats]:
        """The best points of GWO-WOA that differ from each other."""
        count = WindowResidual(self.logs, self.arm, self.joints).windows
        residual = WindowResidual(self.logs, self.arm, self.joints, False, max(1, count // GLOBAL_WINDOWS))
        middle = space.start()
        low, high = space.bounds()
        low, high = np.maximum(low, middle - GLOBAL_SPREAD), np.minimum(high, middle + GLOBAL_SPREAD)
        seen: list[tuple[float, Floats]] = []
        with create(DEFAULT, low, high, budget=GLOBAL_EVALUATIONS, seed=self.seed, start=middle[None]) as pack:
            while not pack.done:
                points = pack.ask()
                # Bounded per number, so that one joint far off does not hide what the others gain.
                costs = np.mean(np.log1p(residual(space, points) ** 2), axis=1)
                pack.tell(costs)
                seen += [(float(cost), point.copy()) for cost, point in zip(costs, points, strict=True)]
                self.simulations += len(points)
                self.globally += len(points)
                self.report("global search", self.globally / GLOBAL_EVALUATIONS)
        kept: list[Floats] = []
        for _, point in sorted(seen, key=lambda one: one[0]):
            if all(np.max(np.abs(point - other)) > 0.5 for other in kept):
                kept.append(point)
            if len(kept) == STARTS:
                break
        return kept

    def _with(self, candidate: Candidate, number: int) -> Candidate:
        """The same model with the next order's quantities at their usual start."""
        order, added = ORDERS[number]
        if order == "zero angles":
            return Candidate(candidate.space, candidate.x, order)
        kinds = dict.fromkeys(parameter.kind for parameter in candidate.space.parameters)
        space = Space.of(self.arm, (*kinds, *added), self.joints)
        return Candidate(space, space.moved(candidate.x, candidate.space), order)

    def _refined(self, candidate: Candidate) -> Candidate:
        """Least squares on the fitted part: under the logged voltages first, then in the closed loop."""
        if candidate.order == "zero angles":
            return self._with_zero_angles(candidate)
        x = candidate.x
        if candidate.order == "motors" and self.loops:
            x = self._fit(self._prior(self._some_windows()), candidate.space, x, WINDOW_STEPS).x
        elif candidate.order == "Coulomb friction" or not self.loops:
            # Smooth and long, this is what the closed loop, full of steps, must start from.
            x = self._fit(self._prior(self._windows(False)), candidate.space, x, WINDOW_STEPS).x
        if self.loops:
            inside = LoopResidual(self._loops_of(candidate.space), self.joints, False)
            x = self._fit(self._prior(_scaled(inside)), candidate.space, x, LOOP_STEPS, LOOP_STEP_SCALE).x
        return Candidate(candidate.space, x, candidate.order)

    def _with_zero_angles(self, candidate: Candidate) -> Candidate:
        """Only gravity shows where zero is, and shows it best where the voltages are given."""
        space = candidate.space.zero_angles_at(candidate.x)
        if not len(space):
            return candidate
        found = self._fit(self._windows(False), space, space.start(), WINDOW_STEPS)
        zero = space.offsets(found.x[None])[0]
        return Candidate(candidate.space.with_zero(zero), candidate.x, candidate.order)

    def _windows(self, held_out: bool) -> WindowResidual:
        return WindowResidual(self.logs, self.arm, self.joints, held_out)

    def _some_windows(self) -> WindowResidual:
        """Every third of the fitted part: enough to come near, for a third of the time."""
        return WindowResidual(self.logs, self.arm, self.joints, False, 3)

    def _loops_of(self, space: Space) -> Sequence[Loop]:
        return [loop.with_zero(space.zero) for loop in self.loops] if space.zero.any() else self.loops

    def _held_out(self, candidate: Candidate) -> Candidate:
        plants = candidate.space.plants(candidate.x[None])
        if self.loops:
            loops = self._loops_of(candidate.space)
            errors = [loop.error(plants, True)[0, list(self.joints)] for loop in loops]
            score = float(np.mean(np.sum(errors, axis=1)))
        else:
            score = float(np.mean(self._windows(True)(candidate.space, candidate.x[None]) ** 2))
        return replace(candidate, held_out=score)

    def _better(self, candidate: Candidate) -> bool:
        best = self.best
        if best is None or best.held_out is None:
            return True
        assert candidate.held_out is not None
        return candidate.held_out < (1.0 - WORTH) * best.held_out

    def _whole(self) -> None:
        """The chosen order once more, on all data."""
        assert self.best is not None
        self.report("fitting the chosen model to the whole log", 0.0)
        best = self.best
        windows = WindowResidual(self.logs, self.arm, self.joints)
        found = self._fit(self._prior(windows), best.space, best.x, WINDOW_STEPS)
        if self.loops:
            inside = self._prior(_scaled(LoopResidual(self._loops_of(best.space), self.joints)))
            ends = [self._fit(inside, best.space, start, LOOP_STEPS, LOOP_STEP_SCALE) for start in (best.x, found.x)]
            found = min(ends, key=lambda one: one.cost)
        self.best = replace(best, x=found.x)
        self.complete = True

    def _fit(
        self, residual: Residual[Space], space: Space, start: Floats, steps: int, step_scale: float = 1.0
    ) -> Fit[Space]:
        found = least_squares_fit(residual, space, start, steps, step_scale)
        self.simulations += found.simulations
        return found

    def _prior(self, residual: Residual[Space]) -> Residual[Space]:
        """Add the user's arm as one weak observation of every number searched by its logarithm."""

        def with_prior(space: Space, points: Floats) -> Floats:
            return np.concatenate([residual(space, points), (points - space.start()) / space.doubts()], axis=1)

        return with_prior


def _scaled(residual: Residual[Space]) -> Residual[Space]:
    return lambda space, points: residual(space, points) / LOOP_DOUBT
