"""Least squares of a search's models: what is fitted to which windows, counted, with the progress of it all."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace

import numpy as np
from threadpoolctl import threadpool_limits

from greywhale.base.types import Flags, Floats, Progress, show_no_progress
from greywhale.identify.candidate import Candidate, WindowsAndLoop
from greywhale.identify.fit import least_squares_fit
from greywhale.identify.knocking import turns_of
from greywhale.identify.space import Space
from greywhale.identify.steps import ENOUGH, ROUGHLY_ENOUGH, WindowFit
from greywhale.identify.windows import WindowResidual

WINDOW_STEPS = 20  # of a fit to windows, at most
LOOP_STEPS = 10  # of one to windows and closed loop
FITS_TO_SETTLE = 3  # so many it often takes until a candidate is settled; only the share that is reported hangs on it
# Readings come in steps, so finite differences in the closed loop are wider than in the windows.
LOOP_STEP_SCALE = 5.0


@dataclass(frozen=True)
class Effort:
    """The length of a fit: its steps at most; how often it chooses anew the side of its gap from which each motor
    starts, and its steps after each choice; the share of the cost that a step must gain.
    """

    steps: int
    choices: int
    steps_after_choice: int
    enough: float


# Twice the choices find no better models.
WHOLE = Effort(WINDOW_STEPS, 2, 8, ENOUGH)
# Of several starts so little shows which one leads on.
ROUGH = Effort(8, 1, 4, ROUGHLY_ENOUGH)


@dataclass
class Fits:
    """The fits of one search. They tell how far it is, by the part that was begun last."""

    joints: Sequence[int]
    report: Progress
    simulations: int = 0
    simulated: float = 0.0  # s
    _part: tuple[str, float, float, float] = field(default=("", 0.0, 1.0, 1.0), init=False, repr=False)

    def begin_part(self, what: str, done: float, until: float, fits: int = 1) -> None:
        """Progress a part of the search; about so many fits take its share from `done` to `until`."""
        self._part = what, done, until, (until - done) / fits
        self.report(what, done)

    def _progress(self, fits: int) -> None:
        what, done, until, each = self._part
        self._part = what, min(until, done + fits * each), until, each
        self.report(what, self._part[1])

    def refine(
        self,
        windows: WindowResidual,
        candidate: Candidate,
        steps: int = WINDOW_STEPS,
        free: Flags | None = None,
        enough: float = ENOUGH,
    ) -> Candidate:
        return replace(candidate, x=self.fit_windows(windows, candidate.space, candidate.x, steps, free, enough))

    def settle(self, windows: WindowResidual, candidate: Candidate, effort: Effort = WHOLE) -> Candidate:
        """Fit a model's numbers in their turns."""
        for seen, free in turns_of(windows, candidate.space, candidate.knocking):
            if candidate.knocking:
                seen.settle(candidate.plant, candidate.zero)
            candidate = self._settle_turn(seen, candidate, free, effort)
        return candidate

    def settle_each(
        self, windows: WindowResidual, candidates: Sequence[Candidate], effort: Effort = WHOLE
    ) -> list[Candidate]:
        """Fit models beside each other, each to windows whose starts are its own. Two at a time: one works in numpy
        while the other simulates.
        """
        apart = [Fits(self.joints, show_no_progress) for _ in candidates]
        seen = [windows.copy() for _ in candidates]
        found: list[Candidate] = []
        with threadpool_limits(limits=1, user_api="blas"), ThreadPoolExecutor(2) as pool:
            fits = [pool.submit(Fits.settle, *one, effort) for one in zip(apart, seen, candidates, strict=True)]
            try:
                for one in fits:
                    found.append(one.result())
                    self._progress(FITS_TO_SETTLE)
            except BaseException:
                pool.shutdown(cancel_futures=True)
                raise
        self.simulations += sum(one.simulations for one in apart)
        self.simulated += sum(one.simulated for one in apart)
        return found

    def _settle_turn(self, windows: WindowResidual, found: Candidate, free: Flags, effort: Effort) -> Candidate:
        """Least squares and the choice of where each window starts in the gaps, in turns until that choice no longer
        changes.
        """
        found = self.refine(windows, found, effort.steps, free, effort.enough)
        for _ in range(effort.choices):
            if not windows.settle(found.plant, found.zero):
                break
            found = self.refine(windows, found, effort.steps_after_choice, free, effort.enough)
        return found

    def mix_blocks(self, windows: WindowResidual, space: Space, fits: Sequence[Floats]) -> Floats:
        """For each group of joints that feel each other, the numbers of the fit that is best for them: others may be
        stuck.
        """
        errors = np.array([windows.mse(space.plants(x[None])[0], space.offsets(x[None])[0]) for x in fits])
        return space.mix(fits, errors[:, list(self.joints)], self.joints)

    def fit_windows(
        self,
        windows: WindowResidual,
        space: Space,
        start: Floats,
        steps: int = WINDOW_STEPS,
        free: Flags | None = None,
        enough: float = ENOUGH,
    ) -> Floats:
        """Run least squares on windows, and count what was simulated."""
        fit = WindowFit(windows, space, start, free, enough)
        what, done, until, each = self._part
        found = fit.run(steps, lambda share: self.report(what, min(until, done + each * share)))
        self._progress(1)
        self.simulations += fit.simulations
        self.simulated += fit.simulations * windows.seconds
        return found

    def fit_with_loop(self, observed: WindowsAndLoop, space: Space, start: Floats) -> Floats:
        """Run least squares with the user's arm as one weak observation, and count what was simulated."""

        def residual(points: Floats) -> Floats:
            return np.concatenate([observed(space, points), (points - space.start()) / space.doubts()], axis=1)

        own = np.array([one.joint for one in space.parameters], dtype=np.intp)
        moves = space.moves(np.concatenate([observed.joint_of, own]))
        moves[len(observed.joint_of) :] = np.eye(len(space), dtype=bool)
        found, simulations = least_squares_fit(residual, space, start, moves, LOOP_STEPS, LOOP_STEP_SCALE)
        self.simulations += simulations
        self.simulated += simulations * observed.seconds
        return found
