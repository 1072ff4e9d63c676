"""The default method: least squares from the user's arm on, then more quantities.

1. Least squares fits motors and Coulomb friction to some windows of the log under its logged voltages. It starts from
   the user's arm and from a fit without friction; the best result goes on. A global search before it adds nothing
   (docs/identify.md).
2. Groups of quantities are added one after the other: Stribeck friction, backlash, zero angles. Each is fitted to three
   quarters of the log's windows, spread all over it. It stays only if the model then predicts the other quarter better.
3. Joints that the windows miss by far may knock about in the gaps of their gears. These gears are fitted to short
   windows, if that predicts held-out ones better.
4. Where the controller is known, a fit to windows and closed loop together competes with the fit to windows alone. It
   wins if it predicts the held-out part of the closed loop better.
5. The chosen model is fitted to the whole log.

A search may begin with a model of the same arm, found from fewer logs. Its quantities are then fitted at once after
step 1, and only orders that it lacks are tried. The model as it is competes with that fit: these logs may show less.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.types import Progress
from greywhale.identify.candidate import Candidate, WindowsAndLoop
from greywhale.identify.closed_loop import Loop, LoopResidual
from greywhale.identify.data import Prepared
from greywhale.identify.fits import FITS_TO_SETTLE, ROUGH, Fits
from greywhale.identify.knocking import knocking_joints, knocking_starts, turns_of, with_better_gears
from greywhale.identify.nearer import cost, far_joints, with_nearer_torque
from greywhale.identify.soft_teeth import with_soft_teeth
from greywhale.identify.space import MOTOR, Space
from greywhale.identify.windows import WindowResidual
from greywhale.loop.leader import SLICE_S

# The quantities that each order of the model adds to the one before.
ORDERS: dict[str, tuple[str, ...]] = {
    "motors": MOTOR,
    "Coulomb friction": ("coulomb",),
    "Stribeck friction": ("breakaway", "stribeck"),
    "backlash": ("gap", "drag", "teeth"),
    "play at the potentiometers": ("play",),
    "load friction": ("load",),
    "creep": ("creep",),
    "lag of the potentiometers": ("lag",),
    "sagging supply": ("sag",),
    "zero angles": ("offset",),
    "drivers that lose volts": ("lost", "uneven"),
    "ringing teeth": ("ringing",),
}
FIRST = ("motors", "Coulomb friction")  # every model has them
# The quantity that an order changes.
NEEDS = {"Stribeck friction": "coulomb", "creep": "coulomb", "ringing teeth": "teeth"}
# What is tried after motors and Coulomb friction, one line after the other. Orders of one line explain much the same,
# so they compete; the losers are tried again on top of the winner. An order that did not help may do so later.
TURNS: tuple[tuple[str, ...], ...] = (
    ("Stribeck friction",),
    ("backlash", "play at the potentiometers", "drivers that lose volts"),
    ("Stribeck friction", "load friction", "creep"),
    ("zero angles",),
    ("lag of the potentiometers", "sagging supply", "ringing teeth"),
)
# A gear's numbers have several optima. So least squares starts from each of these too: half of the gap in rad, drag,
# bend of the teeth in rad.
GEARS: tuple[dict[str, float], ...] = (
    {"gap": 2e-3, "drag": 0.1, "teeth": 2e-3},
    {"gap": 5e-3, "drag": 0.1, "teeth": 2e-3},
    {"gap": 3e-3, "drag": 0.03, "teeth": 5e-3},
)
# The gear that a joint has which swings on its teeth, but for how far these bend.
SWINGING = {"gap": 0.0, "drag": 0.01, "teeth": 2e-3}
SOME_WINDOWS = 20
ROUNDS = 2


@dataclass
class Search:
    """Everything found so far. An interrupt loses only the rest of the search."""

    arm: ArmParameters
    logs: Sequence[Prepared]
    loops: Sequence[Loop]  # of the same logs; empty where no controller is known
    joints: Sequence[int]
    seed: int
    report: Progress
    begin: Candidate | None = None  # a model of this arm, found from other logs
    best: Candidate | None = None
    tried: list[Candidate] = field(default_factory=list)
    complete: bool = False

    def __post_init__(self) -> None:
        self.fits = Fits(self.joints, self.report)
        self._fitted = WindowResidual(self.logs, self.arm, self.joints, False)
        self._held = WindowResidual(self.logs, self.arm, self.joints, True)
        self._limits = self._held.limits.search
        self._far: Candidate | None = None

    def run(self) -> None:
        self.fits.begin_part("fitting the motors", 0.0, 1.0)
        self._consider(self._fit_motors())
        self._consider(self._fit_friction())
        if self.begin is not None:
            self._consider(self._fit_begun(self.begin))
            self._consider(self.begin)
        # An order that did not help at first may do so once the later ones are known.
        for _ in range(ROUNDS if self.begin is None else 1):
            before = self.best
            for number, turn in enumerate(TURNS):
                self._consider_rivals(turn, number)
                self._consider_softer()
                self._consider_nearer()
            if self.best is before:
                break
        if self.begin is None:
            self._consider_fewer()
        self._consider_knocking()
        if self.loops:
            self._consider_closed()
        self._fit_whole()

    def rivals(self) -> list[Candidate]:
        """Other orders that predict the held-out part nearly as well as the best, the best of them first."""
        best = self.best
        if best is None or best.held_out is None:
            return []
        most, own = best.held_out + self._limits.rival_margin, set(best.space.names)
        others = [one for one in self.tried if one.held_out is not None and one.held_out < most]
        others = [one for one in others if set(one.space.names) != own]
        return sorted(others, key=lambda one: float(one.held_out or 0.0))[: self._limits.max_rivals]

    def _consider_rivals(self, turn: Sequence[str], number: int) -> None:
        """Try each of some orders on top of the best model, take the one that helps most, and try the others again."""
        left = [order for order in turn if self._may_follow(order)]
        while left:
            what, share = "choosing the model's order", 1.0 / len(TURNS)
            done = share * (number + 1 - len(left) / len(turn))
            self.fits.begin_part(what, done, done)
            before = self.best
            assert before is not None
            extended = [(self._extend(before, order), order) for order in left]
            extended = [(one, order) for one, order in extended if not self._was_tried(one)]
            if not extended:
                return
            fits = sum(len(GEARS) + 2 if order == "backlash" else 1 for _, order in extended)
            self.fits.begin_part(what, done, done + share / len(turn), FITS_TO_SETTLE * fits)
            found = [self._measure(one) for one in self._fit_orders(extended)]
            errors = [float(one.held_out or 0.0) + self._least_gain(one) for one in found]
            winner = int(np.argmin(errors))
            self._take(found[winner])
            if self.best is before:
                return
            left = [order for order in left if self._may_follow(order)]

    def _consider_fewer(self) -> None:
        """Leave out orders that later ones have made needless, one after the other."""
        while True:
            best = self.best
            assert best is not None
            assert best.held_out is not None
            orders = [one for one in self._last_orders(best) if not self._was_tried(self._shorten(best, one))]
            self.fits.begin_part("leaving out needless orders", 0.0, 1.0, FITS_TO_SETTLE * (len(orders) + 1))
            fewer = self.fits.settle_each(self._fitted, [self._shorten(best, one) for one in orders], ROUGH)
            margins = [self._least_gain_of(order) for order in orders]
            lost = [self._error(one) - best.held_out - margin for one, margin in zip(fewer, margins, strict=True)]
            if not lost or min(lost) > 0.0:
                return
            least = int(np.argmin(lost))
            found = self._measure(self.fits.settle(self._fitted, fewer[least]))
            if float(found.held_out or 0.0) > best.held_out + margins[least]:
                return
            self.best = found

    def _last_orders(self, candidate: Candidate) -> list[str]:
        """Orders of a model that none of its other orders changes."""
        kinds = candidate.kinds
        changed = {quantity for order, quantity in NEEDS.items() if ORDERS[order][0] in kinds}
        present = [order for order, own in ORDERS.items() if own[0] in kinds and not changed & set(own)]
        return [order for order in present if order not in FIRST]

    def _shorten(self, candidate: Candidate, order: str) -> Candidate:
        """Return the model without the quantities of an order."""
        space = Space.of(self.arm, [one for one in candidate.kinds if one not in ORDERS[order]], self.joints)
        left = [one for one in candidate.order.split(", ") if one != order]
        return Candidate(space, space.translate(candidate.x, candidate.space), ", ".join(left) or FIRST[-1])

    def _consider_softer(self) -> None:
        """Look for soft teeth again where the model has found play since: play hides the swings."""
        assert self.best is not None
        kinds = self.best.kinds
        if self.begin is None and kinds[-1] == "play" and "teeth" in kinds:
            softer = self._soften(self.best)
            if softer is not self.best:
                self._consider(softer)

    def _consider_nearer(self) -> None:
        """Fit joints whose torque per volt is far off from nearer by, too; far off stays what the log tells."""
        assert self.best is not None
        if self.best is self._far or not (far := far_joints(self.best, self._limits)):
            return
        gears = ({}, *GEARS) if "gap" in self.best.kinds else ({},)
        tried = [self.best, self._fit_best([with_nearer_torque(self.best, far, gear) for gear in gears])]
        errors = np.array([cost(one, self._held) for one in tried])
        errors[:, ~np.isin(self.joints, far)] = 0.0  # they stay as they are
        mixed = self.best.space.mix([one.x for one in tried], errors, self.joints)
        if not np.array_equal(mixed, self.best.x):
            self.best = self._measure(replace(self.best, x=mixed))
        self._far = self.best  # where it is

    def _fit_orders(self, extended: Sequence[tuple[Candidate, str]]) -> list[Candidate]:
        """Fit each order's quantities along with the others, those of gears from several starts."""
        others = iter(self.fits.settle_each(self._fitted, [one for one, order in extended if order != "backlash"]))
        return [self._fit_gears(one) if order == "backlash" else next(others) for one, order in extended]

    def _fit_gears(self, candidate: Candidate) -> Candidate:
        return self._soften(self._fit_best([candidate, *(candidate.with_values(gear) for gear in GEARS)]))

    def _soften(self, stiff: Candidate) -> Candidate:
        """Fit softer teeth, where joints seem to swing on them. A light link that knocks about in its gap looks like
        that, too: what is held out decides.
        """
        soft = with_soft_teeth(self._fitted, stiff, stiff.with_values(SWINGING), self.logs)
        if soft is None:
            return stiff
        bent = self._fit_best([stiff, soft])
        return bent if self._error(bent) < self._error(stiff) - self._limits.soft_teeth else stiff

    def _consider_knocking(self) -> None:
        """Fit gears to short windows, where joints may knock about in their gaps; held-out ones decide for each."""
        best = self.best
        assert best is not None
        knocking = knocking_joints(self._fitted, best) if "gap" in best.kinds else ()
        if not knocking:
            return
        known = () if self.begin is None else (replace(best, x=best.space.translate(self.begin.x, self.begin.space)),)
        starts = knocking_starts(best, knocking, known, self.logs)
        self.fits.begin_part("fitting gears to short windows", 0.0, 1.0, 2 * FITS_TO_SETTLE * (len(starts) + 2))
        found = with_better_gears(best, self._fit_best(starts), self._held)
        if found.knocking:
            self.best = self._measure(self.fits.settle(self._fitted, found))

    def _fit_begun(self, begin: Candidate) -> Candidate:
        """Fit the quantities of the model to begin with, from its values and from this search's own."""
        assert self.best is not None
        self.fits.begin_part("fitting the model from before", 0.0, 1.0, FITS_TO_SETTLE * (len(GEARS) + 3))
        own = replace(begin, x=begin.space.translate(self.best.x, self.best.space))
        gears = [own.with_values(gear) for gear in GEARS] if "gap" in begin.kinds else []
        return self._fit_best([begin, own, *gears])

    def _fit_best(self, starts: Sequence[Candidate]) -> Candidate:
        """Fit one model roughly from several starts; the best goes on for each group of joints that feel each other."""
        if len(starts) == 1:
            return self.fits.settle(self._fitted, starts[0])
        tried = self.fits.settle_each(self._fitted, starts, ROUGH)
        seen = turns_of(self._fitted, starts[0].space, starts[0].knocking)[0][0]  # those that gears are fitted to
        errors = np.array([seen.settled_error(one.plant, one.zero) for one in tried])
        mixed = tried[0].space.mix([one.x for one in tried], errors, self.joints)
        return self.fits.settle(self._fitted, replace(tried[0], x=mixed))

    def _was_tried(self, candidate: Candidate) -> bool:
        return any(set(one.space.names) == set(candidate.space.names) for one in self.tried)

    def _may_follow(self, order: str) -> bool:
        """True where the best model lacks this order, and has what the order changes."""
        best = self.best
        assert best is not None
        kinds = best.kinds
        return ORDERS[order][0] not in kinds and (order not in NEEDS or NEEDS[order] in kinds)

    def _consider(self, candidate: Candidate) -> None:
        self._take(self._measure(candidate))

    def _measure(self, candidate: Candidate) -> Candidate:
        measured = replace(candidate, held_out=self._error(candidate))
        self.tried.append(measured)
        return measured

    def _take(self, candidate: Candidate) -> None:
        """Take a measured candidate if it predicts the held-out part better than the best so far."""
        best, error = self.best, candidate.held_out
        assert error is not None
        if best is None or best.held_out is None or error < best.held_out - self._least_gain(candidate):
            self.best = candidate

    def _least_gain(self, candidate: Candidate) -> float:
        """The gain that a candidate must have over the best so far."""
        new = self.best is not None and "lost" in candidate.kinds and "lost" not in self.best.kinds
        return self._least_gain_of("drivers that lose volts" if new else "")

    def _least_gain_of(self, order: str) -> float:
        return self._limits.lossy_drivers if order == "drivers that lose volts" else self._limits.min_improvement

    def _error(self, candidate: Candidate) -> float:
        return float(np.mean(self._held.settled_error(candidate.plant, candidate.zero)))

    def _fit_motors(self) -> Candidate:
        """Motors alone, starting from the user's values."""
        space = Space.of(self.arm, MOTOR, self.joints)
        return self.fits.refine(self._some_windows(), Candidate(space, space.start(), "motors"))

    def _fit_friction(self) -> Candidate:
        """Least squares from the user's arm and from the fit without friction; the best by the fitted data."""
        space = Space.of(self.arm, (*MOTOR, "coulomb"), self.joints)
        motors = self.tried[0]
        starts = [space.start(), space.translate(motors.x, motors.space)]
        residual = self._some_windows()
        # The last fit sees so many times the windows of the others.
        what, parts = "least squares from several starts", len(starts) + max(1, self._fitted.windows // SOME_WINDOWS)
        fits = []
        for number, point in enumerate(starts):
            self.fits.begin_part(what, number / parts, (number + 1) / parts)
            fits.append(self.fits.fit_windows(residual, space, point))
        self.fits.begin_part(what, len(starts) / parts, 1.0)
        return self.fits.refine(
            self._fitted, Candidate(space, self.fits.mix_blocks(self._fitted, space, fits), "Coulomb friction")
        )

    def _extend(self, candidate: Candidate, order: str) -> Candidate:
        """Return the model with the quantities of another order added, at their usual start."""
        space = Space.of(self.arm, (*candidate.kinds, *ORDERS[order]), self.joints)
        name = order if candidate.order in FIRST else f"{candidate.order}, {order}"
        return Candidate(space, space.translate(candidate.x, candidate.space), name)

    def _consider_closed(self) -> None:
        """Fit windows and closed loop together; keep the fit if it predicts the held-out part of the closed loop
        better.
        """
        assert self.best is not None
        self.fits.begin_part("comparing with the closed loop", 0.0, 0.0)
        closed = self._fit_closed(self._fitted, self.best, whole=False)
        share = 1.0 - self._limits.min_closed_improvement
        if self._closed_error(closed) < share * self._closed_error(self.best):
            self.best = closed

    def _fit_closed(self, windows: WindowResidual, candidate: Candidate, whole: bool) -> Candidate:
        both = WindowsAndLoop(windows, LoopResidual(self._loops_of(candidate), self.joints, whole), candidate)
        return replace(candidate, x=self.fits.fit_with_loop(both, candidate.space, candidate.x), closed=True)

    def _closed_error(self, candidate: Candidate) -> float:
        errors = [loop.error(candidate.plant[None], True)[0, list(self.joints)] for loop in self._loops_of(candidate)]
        return float(np.mean(np.sum(errors, axis=1)))

    def _some_windows(self) -> WindowResidual:
        """As many windows of the fitted part as it takes to come near the optimum in less time."""
        return WindowResidual(self.logs, self.arm, self.joints, False, max(1, self._fitted.windows // SOME_WINDOWS))

    def _loops_of(self, candidate: Candidate) -> Sequence[Loop]:
        zero = candidate.zero
        return [loop.with_zero(zero) for loop in self.loops] if zero.any() else self.loops

    def _fit_whole(self) -> None:
        """Fit the chosen order once more, on all data."""
        assert self.best is not None
        self.fits.begin_part("fitting the chosen model to the whole log", 0.0, 1.0, FITS_TO_SETTLE * 3)
        if self.begin is None:
            self.best = self._retry_optima(self.best)
        windows = WindowResidual(self.logs, self.arm, self.joints, longest_step=SLICE_S)
        windows.settle(self.best.plant, self.best.zero)
        found = self.fits.settle(windows, self.best)
        self.best = self._fit_closed(windows, found, whole=True) if self.best.closed else found
        self.complete = True

    def _retry_optima(self, candidate: Candidate) -> Candidate:
        """Try another optimum again: the motion that tells a joint's optima apart may be in the held-out part."""
        windows = WindowResidual(self.logs, self.arm, self.joints)
        space = Space.of(self.arm, (*MOTOR, "coulomb"), self.joints)
        starts = (space.start(), space.translate(candidate.x, candidate.space))
        simple = self.fits.mix_blocks(windows, space, [self.fits.fit_windows(windows, space, x) for x in starts])
        names = dict(zip(space.names, simple, strict=True))
        other = np.array([names.get(name, x) for name, x in zip(candidate.space.names, candidate.x, strict=True)])
        # A joint that feels no gravity hardly shows its alpha: a difference in alpha alone is no other optimum.
        told = np.array([parameter.kind != "alpha" for parameter in candidate.space.parameters])
        if np.max(np.abs(other - candidate.x)[told]) < self._limits.other_optimum:
            return candidate
        tried = self.fits.settle_each(windows, [replace(candidate, x=x) for x in (candidate.x, other)])
        costs = np.array([cost(one, windows) for one in tried])
        return replace(candidate, x=candidate.space.mix([one.x for one in tried], costs, self.joints))
