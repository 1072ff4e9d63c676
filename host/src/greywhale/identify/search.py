"""The default method: a global search seeded with the user's arm, least squares, then as many quantities as held-out
data ask for.

1. GWO-WOA over motors and Coulomb friction, on some windows of the log under its logged voltages.
2. Least squares from the user's arm and from the best different points of that search; the best of them goes on.
3. One group of quantities after the other is added: Stribeck friction, backlash, zero angles. Each is fitted to three
   quarters of the log's windows, spread all over it, and stays only if the other quarter is predicted better with it.
4. Where the controller is known, a fit to windows and closed loop together competes with the windows alone, and wins
   if the held-out part of the closed loop is predicted better.
5. What was chosen is fitted to the whole log.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from greywhale.arm import ArmParameters
from greywhale.identify.closed_loop import Loop, LoopResidual
from greywhale.identify.data import FINE_STEP_S, Prepared
from greywhale.identify.fit import Pattern, differing, least_squares_fit
from greywhale.identify.space import COUPLED, MOTOR, Space
from greywhale.identify.steps import WindowFit
from greywhale.identify.windows import WindowResidual
from greywhale.optimise import DEFAULT, create

Floats = NDArray[np.float64]
Report = Callable[[str, float], None]

# What each order of the model adds to the one before.
ORDERS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("motors", MOTOR),
    ("Coulomb friction", ("coulomb",)),
    ("Stribeck friction", ("breakaway", "stribeck")),
    ("backlash", ("gap", "drag", "teeth")),
    ("zero angles", ("offset",)),
)
# An order with more quantities must predict the held-out data better by this share of 1 + squares over noise.
WORTH = 0.01
# So must the closed loop, which is rough: chance alone moves its error by a tenth.
WORTH_CLOSED = 0.2
# A closed-loop difference of this size counts as one standard deviation (rad): it lasts for many readings.
LOOP_DOUBT = 1e-2
GLOBAL_EVALUATIONS = 500
GLOBAL_WINDOWS = 12
SOME_WINDOWS = 20
GLOBAL_SPREAD = 2.5  # the box of the global search: factors e^(+-2.5) around the user's arm
STARTS = 2  # of the global search's points that least squares starts from, beside the user's arm
WINDOW_STEPS = 20
LOOP_STEPS = 10
# From which side of its gap each motor starts is chosen anew so often at most, each time for some steps of the fit.
SETTLINGS = 4
SETTLED_STEPS = 8
# Searched numbers that differ by so much are another optimum, worth a fit of its own.
ELSEWHERE = 0.3
# Readings come in steps, so finite differences in the closed loop are taken wider than in the windows.
LOOP_STEP_SCALE = 5.0


class Observed(Protocol):
    """A residual that knows of which joint each of its numbers is, and how many seconds a candidate costs."""

    joint_of: NDArray[np.intp]
    seconds: float

    def __call__(self, space: Space, points: Floats) -> Floats: ...


@dataclass(frozen=True)
class Candidate:
    """A model on its way; `held_out` is its error on windows that it was not fitted to, None before it was measured."""

    space: Space
    x: Floats
    order: str
    held_out: float | None = None
    closed: bool = False  # fitted to the closed loop too

    @property
    def plant(self) -> Floats:
        found: Floats = self.space.plants(self.x[None])[0]
        return found

    @property
    def zero(self) -> Floats:
        found: Floats = self.space.offsets(self.x[None])[0]
        return found


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
    simulated: float = 0.0  # s
    globally: int = 0
    complete: bool = False

    def __post_init__(self) -> None:
        self._fitted = WindowResidual(self.logs, self.arm, self.joints, False)
        self._held = WindowResidual(self.logs, self.arm, self.joints, True)

    def run(self) -> None:
        self.report("fitting the motors", 0.0)
        self._consider(self._motors())
        self._consider(self._with_friction())
        # What was of no use before backlash was known may be of use with it.
        for step, number in enumerate((2, 3, 2, 4)):
            self.report("choosing the model's order", step / 4)
            self._consider_order(number)
        if self.loops:
            self._consider_closed()
        self._whole()

    def _consider_order(self, number: int) -> None:
        best = self.best
        assert best is not None
        order, added = ORDERS[number]
        kinds = {parameter.kind for parameter in best.space.parameters}
        # Without Coulomb friction there is none at rest; and what is there need not be tried.
        if added[0] in kinds or (order == "Stribeck friction" and "coulomb" not in kinds):
            return
        candidate = self._with(best, number)
        if order == "Stribeck friction" and "gap" in kinds:
            candidate = replace(candidate, order=f"{order} with {best.order}")
        elif number == 2 and any(one.order == order for one in self.tried):
            return
        self._consider(self._settled(self._fitted, candidate))

    def _consider(self, candidate: Candidate) -> None:
        error = self._error(candidate)
        measured = replace(candidate, held_out=error)
        self.tried.append(measured)
        best = self.best
        if best is None or best.held_out is None or error < best.held_out - WORTH:
            self.best = measured

    def _error(self, candidate: Candidate) -> float:
        """Misfit of the held-out windows: the mean over windows and joints of log(1 + squares over noise).

        Log, as else the one motion that the fitted part lacks would outweigh all that it has.
        """
        self._held.settle(candidate.plant, candidate.zero)
        return float(np.mean(np.log1p(self._held.misfit(candidate.plant, candidate.zero))))

    def _motors(self) -> Candidate:
        """Motors alone, from where the user has them."""
        space = Space.of(self.arm, MOTOR, self.joints)
        return self._refined(self._some_windows(), Candidate(space, space.start(), ORDERS[0][0]))

    def _with_friction(self) -> Candidate:
        """Global search, then least squares from several points; the best by the fitted data."""
        space = Space.of(self.arm, (*MOTOR, "coulomb"), self.joints)
        motors = self.tried[0]
        starts = [space.start(), space.moved(motors.x, motors.space), *self._global(space)]
        residual = self._some_windows()
        fits = []
        for number, point in enumerate(starts):
            self.report("least squares from several starts", number / len(starts))
            fits.append(self._fit_windows(residual, space, point, WINDOW_STEPS))
        return self._refined(self._fitted, Candidate(space, self._mixed(self._fitted, space, fits), ORDERS[1][0]))

    def _mixed(self, windows: WindowResidual, space: Space, fits: Sequence[Floats]) -> Floats:
        """Of joints that feel each other the numbers of the fit that is best for them: others may be stuck."""
        errors = np.array([windows.mse(space.plants(x[None])[0], space.offsets(x[None])[0]) for x in fits])
        mixed = fits[0].copy()
        for joints in COUPLED:
            best = fits[int(np.argmin(errors[:, list(joints)].sum(axis=1)))]
            mine = [index for index, one in enumerate(space.parameters) if one.joint in joints]
            mixed[mine] = best[mine]
        return mixed

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
                self.simulated += len(points) * residual.seconds
                self.globally += len(points)
                self.report("global search", self.globally / GLOBAL_EVALUATIONS)
        return differing(seen, STARTS)

    def _with(self, candidate: Candidate, number: int) -> Candidate:
        """The same model with the next order's quantities at their usual start."""
        order, added = ORDERS[number]
        kinds = dict.fromkeys(parameter.kind for parameter in candidate.space.parameters)
        space = Space.of(self.arm, (*kinds, *added), self.joints)
        return Candidate(space, space.moved(candidate.x, candidate.space), order)

    def _refined(self, windows: WindowResidual, candidate: Candidate, steps: int = WINDOW_STEPS) -> Candidate:
        return replace(candidate, x=self._fit_windows(windows, candidate.space, candidate.x, steps))

    def _settled(self, windows: WindowResidual, candidate: Candidate) -> Candidate:
        """Least squares and the choice of where each window starts in the gaps, in turns until that no longer moves."""
        found = self._refined(windows, candidate)
        for _ in range(SETTLINGS):
            if not windows.settle(found.plant, found.zero):
                break
            found = self._refined(windows, found, SETTLED_STEPS)
        return found

    def _consider_closed(self) -> None:
        """Fit windows and closed loop together; keep that if the held-out part of the closed loop is the better."""
        assert self.best is not None
        self.report("comparing with the closed loop", 0.0)
        closed = self._closed(self._fitted, self.best, whole=False)
        if self._closed_error(closed) < (1.0 - WORTH_CLOSED) * self._closed_error(self.best):
            self.best = closed

    def _closed(self, windows: WindowResidual, candidate: Candidate, whole: bool) -> Candidate:
        both = Both(windows, LoopResidual(self._loops_of(candidate), self.joints, whole), candidate)
        x = self._fit(both, candidate.space, candidate.x, LOOP_STEPS, LOOP_STEP_SCALE)
        return replace(candidate, x=x, closed=True)

    def _closed_error(self, candidate: Candidate) -> float:
        errors = [loop.error(candidate.plant[None], True)[0, list(self.joints)] for loop in self._loops_of(candidate)]
        return float(np.mean(np.sum(errors, axis=1)))

    def _some_windows(self) -> WindowResidual:
        """Of the fitted part as many as it takes to come near, in less time."""
        return WindowResidual(self.logs, self.arm, self.joints, False, max(1, self._fitted.windows // SOME_WINDOWS))

    def _loops_of(self, candidate: Candidate) -> Sequence[Loop]:
        zero = candidate.zero
        return [loop.with_zero(zero) for loop in self.loops] if zero.any() else self.loops

    def _whole(self) -> None:
        """The chosen order once more, on all data."""
        assert self.best is not None
        self.report("fitting the chosen model to the whole log", 0.0)
        self.best = self._unstuck(self.best)
        windows = WindowResidual(self.logs, self.arm, self.joints, longest_step=FINE_STEP_S)
        windows.settle(self.best.plant, self.best.zero)
        found = self._settled(windows, self.best)
        self.best = self._closed(windows, found, whole=True) if self.best.closed else found
        self.complete = True

    def _unstuck(self, candidate: Candidate) -> Candidate:
        """The motion that tells a joint's optimum from another may be in the part that was held out: try that again."""
        windows = WindowResidual(self.logs, self.arm, self.joints)
        space = Space.of(self.arm, (*MOTOR, "coulomb"), self.joints)
        starts = (space.start(), space.moved(candidate.x, candidate.space))
        simple = self._mixed(windows, space, [self._fit_windows(windows, space, x, WINDOW_STEPS) for x in starts])
        names = dict(zip(space.names, simple, strict=True))
        other = np.array([names.get(name, x) for name, x in zip(candidate.space.names, candidate.x, strict=True)])
        # A joint that feels no gravity hardly knows its alpha: that one alone is no other optimum.
        told = np.array([parameter.kind != "alpha" for parameter in candidate.space.parameters])
        if np.max(np.abs(other - candidate.x)[told]) < ELSEWHERE:
            return candidate
        tried = [self._settled(windows, replace(candidate, x=x)).x for x in (candidate.x, other)]
        return replace(candidate, x=self._mixed(windows, candidate.space, tried))

    def _fit_windows(self, windows: WindowResidual, space: Space, start: Floats, steps: int) -> Floats:
        """Where least squares on windows ends; counts what was simulated."""
        fit = WindowFit(windows, space, start)
        found = fit.run(steps)
        self.simulations += fit.simulations
        self.simulated += fit.simulations * windows.seconds
        return found

    def _fit(self, observed: Observed, space: Space, start: Floats, steps: int, scale: float = 1.0) -> Floats:
        """Where least squares ends, the user's arm counting as one weak observation; counts what was simulated."""

        def residual(space: Space, points: Floats) -> Floats:
            return np.concatenate([observed(space, points), (points - space.start()) / space.doubts()], axis=1)

        own = np.array([one.joint for one in space.parameters], dtype=np.intp)
        moves = space.moves(np.concatenate([observed.joint_of, own]))
        moves[len(observed.joint_of) :] = np.eye(len(space), dtype=bool)
        found = least_squares_fit(residual, space, start, steps, scale, pattern=Pattern(space.groups(), moves))
        self.simulations += found.simulations
        self.simulated += found.simulations * observed.seconds
        return found.x


class Both:
    """Windows and closed loop in one residual, each in standard deviations of what it cannot help to miss."""

    def __init__(self, windows: WindowResidual, loops: LoopResidual, candidate: Candidate) -> None:
        self._windows = windows
        self._loops = loops
        self.joint_of = np.concatenate([windows.joint_of, loops.joint_of])
        self.seconds = windows.seconds + loops.seconds
        # What the model cannot explain in the windows is no noise of single readings, but weighs like it.
        missed = windows(candidate.space, candidate.x[None])
        self._scale = max(1.0, float(np.sqrt(np.mean(missed**2))))

    def __call__(self, space: Space, points: Floats) -> Floats:
        parts = self._windows(space, points) / self._scale, self._loops(space, points) / LOOP_DOUBT
        return np.concatenate(parts, axis=1)
