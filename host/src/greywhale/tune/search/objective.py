"""The cost of a controller, joint by joint, over all plants and classes of motion, with the firmware's own integers.

The error of a joint in a class is a length (rad), the sum of

- the mean of |e|, with the weights of `training`;
- `rms_weight` times the root of the mean of e^2, without weights: this is what the paper's tables measure, and it
  arises mostly during moves.

A class counts relative to what is possible in it (`ErrorScale`): 0 is the error of the ideal controller, 1 that of the
controller from before. So fine following counts as much as large moves, whose error is ten times as large, but mostly
cannot be helped. To this come, in every class,

- `rattle_weight` times the rattling (`rattle`, rad), on the same scale, and `louder_weight` times that for what is
  beyond the rattling from before;
- `chatter_weight` for every `chatter_moving_hz` of duty swings beyond those that a moving gear bears, `shaking_weight`
  for every `rattle_moving_rad` of rattling: at these the margin while moving is lost;
- `effort_weight` times the mean of |u| as a share of the supply, weighted like |e|.

The cost of the class is the root of this sum, because the last tenth of the way matters more than the first. Large
moves count half, and the two classes of fine following the other half. Of the plants, the mean counts half, and the
worst plant the other half.
The weights are in `CostLimits`. With E, F and B the errors of candidate, ideal controller and the one before, R and R0
the rattling and that before, a class costs

    root of  (E - F + 9 R + 27 max(0, R - R0)) / (B - F)  +  0.02 |u| / supply
             +  0.3 max(0, chatter / 100 Hz - 0.7)  +  max(0, R / 5 mrad - 0.7)

`margins` adds the price of unrest, in the mean over the plants, where quiet is the ripple that is allowed at rest:

    0.05 ripple / quiet  +  max(0, ripple / quiet - 0.9)  +  for each margin at rest:
    0.5 travel  +  0.15 if it fails (softer teeth: 0.08)  +  10 if it is lost

All of it is worked out by `host/native/score`, for a page too; tests/tune/reference.py repeats it slowly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from greywhale import _native
from greywhale.base.limits import numbers_in
from greywhale.base.types import Controllers, Floats
from greywhale.measure.limits import SWING_BOUNDS, SwingBounds
from greywhale.measure.swings import FOR_SIMULATIONS, first_block
from greywhale.protocol.firmware import JOINTS, pwm_steps
from greywhale.tune.limits import TUNING_LIMITS, CostLimits
from greywhale.tune.search.training import WAIT_S, TrainingMotion


def pair_with_plants(controllers: Controllers, plants: Floats) -> tuple[Controllers, Floats]:
    """Pair every controller with every plant: n k rows of both, the plants of one controller beside each other."""
    laws = np.repeat(controllers, len(plants), axis=0)
    arms = np.tile(plants, (len(controllers), 1))
    return np.ascontiguousarray(laws), np.ascontiguousarray(arms)


@dataclass(frozen=True)
class FollowingErrors:
    """Errors of candidates, with their voltage, rattling and chatter: (n, plants, classes, 4) each."""

    error: Floats  # rad, see the head
    volts: Floats  # V, weighted mean of |u|
    rattle: Floats  # rad
    chatter: Floats  # 1/s


@dataclass(frozen=True)
class ErrorScale:
    """Errors that are possible on every plant in every class, beside those before: (plants, classes, 4) each, in rad.

    `room` is the way from the floor to the error before.
    """

    floor: Floats
    room: Floats
    rattle: Floats

    def first(self, plants: int) -> ErrorScale:
        """Return the scale of the first few plants only."""
        return ErrorScale(self.floor[:plants], self.room[:plants], self.rattle[:plants])


@dataclass(frozen=True)
class Objective:
    """The training motions and the plants on which candidates are judged, by what is possible."""

    drills: Sequence[TrainingMotion]
    plants: Floats
    scale: ErrorScale
    threads: int = 0
    limits: CostLimits = TUNING_LIMITS.cost
    swings: SwingBounds = SWING_BOUNDS

    def costs(self, controllers: Controllers, exact: bool = False) -> Floats:
        """(n, 4), over all plants; without the price of unrest. `exact`: in the bench's own arithmetic."""
        return self.costs_of(self.follow(controllers, exact))

    def follow(self, controllers: Controllers, exact: bool = False) -> FollowingErrors:
        """The candidates' errors on all motions and plants."""
        return follow(self.drills, self.plants, controllers, exact=exact, threads=self.threads, limits=self.limits)

    def costs_of(self, found: FollowingErrors) -> Floats:
        """The costs (n, 4) of candidates that were simulated."""
        supply = self.drills[0].experiment.table.supply_v
        relative = relative_costs(found, self.scale, supply, self.limits, self.swings)
        return total_costs(relative, [drill.importance for drill in self.drills], self.limits)


def relative_costs(
    found: FollowingErrors,
    scale: ErrorScale,
    supply_v: float,
    limits: CostLimits = TUNING_LIMITS.cost,
    swings: SwingBounds = SWING_BOUNDS,
) -> Floats:
    """The cost of every class: (n, plants, classes, 4)."""
    costs = _native.relative_costs(
        found=_rows(found.error, found.volts, found.rattle, found.chatter),
        scale=_rows(scale.floor, scale.room, scale.rattle),
        supply_v=supply_v,
        cost=numbers_in(limits),
        swings=numbers_in(swings),
    )
    return np.asarray(costs)


def _rows(*values: Floats) -> Floats:
    """Values side by side, as the compiled code has them."""
    return np.ascontiguousarray(np.stack(values, axis=-1))


def total_costs(relative: Floats, importances: Sequence[float], limits: CostLimits = TUNING_LIMITS.cost) -> Floats:
    """The costs (n, 4): of all classes, by their importance, and of the plants a part of the mean, and of the worst."""
    return np.asarray(_native.total_costs(relative=relative, importances=importances, cost=numbers_in(limits)))


def follow(
    drills: Sequence[TrainingMotion],
    plants: Floats,
    controllers: Controllers,
    *,
    exact: bool = False,
    threads: int = 0,
    limits: CostLimits = TUNING_LIMITS.cost,
) -> FollowingErrors:
    """Simulate every candidate on every plant and motion; `exact`: in the bench's own arithmetic."""
    laws, arms = pair_with_plants(controllers, plants)
    found = [_follow(drill, laws, arms, exact, threads, limits) for drill in drills]
    rows = np.stack(found, axis=1).reshape(len(controllers), len(plants), len(drills), JOINTS, -1)
    return FollowingErrors(*np.moveaxis(rows, -1, 0))


def _follow(
    drill: TrainingMotion, laws: Controllers, arms: Floats, exact: bool, threads: int, limits: CostLimits
) -> Floats:
    """Error, volts, rattling and chatter (rows, 4, 4) of one motion."""
    run = drill.experiment.run_exact if exact else drill.experiment.run
    found = _native.follow(
        result=run(laws, arms, every=1, threads=threads),
        pwm_top=pwm_steps(drill.experiment.table.board),
        leader=drill.experiment.leader,
        total_weight=drill.total_weight,
        first_block=first_block(WAIT_S),
        measure=FOR_SIMULATIONS,
        cost=numbers_in(limits),
    )
    return np.asarray(found)
