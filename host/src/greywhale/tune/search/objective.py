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
`margins` adds the price of a joint that does not come to rest. The weights are in `CostLimits`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from greywhale.base.types import Controllers, Floats
from greywhale.loop import Result
from greywhale.measure.limits import SWING_BOUNDS, SwingBounds
from greywhale.measure.swings import chatter, rattle
from greywhale.protocol.firmware import JOINTS
from greywhale.tune.limits import TUNING_LIMITS, CostLimits
from greywhale.tune.search.training import WAIT_S, TrainingMotion


def combine_plants(values: Floats, worst_share: float = TUNING_LIMITS.cost.worst_plant_share) -> Floats:
    """Combine values (n, k, 4) over k plants to (n, 4): a part of the mean, and a part of the worst."""
    mixed: Floats = (1.0 - worst_share) * values.mean(axis=1) + worst_share * values.max(axis=1)
    return mixed


def pair_with_plants(controllers: Controllers, plants: Floats) -> tuple[Controllers, Floats]:
    """Pair every controller with every plant: n k rows of both, the plants of one controller beside each other."""
    laws = np.repeat(controllers, len(plants), axis=0)
    arms = np.tile(plants, (len(controllers), 1))
    return np.ascontiguousarray(laws), np.ascontiguousarray(arms)


def error_of(weighted: Floats, square: Floats, limits: CostLimits = TUNING_LIMITS.cost) -> Floats:
    """The error in rad, of the weighted mean of |e| and the mean of e^2."""
    return weighted + limits.rms_weight * np.sqrt(square)


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
        found = follow(self.drills, self.plants, controllers, exact=exact, threads=self.threads, limits=self.limits)
        supply = self.drills[0].experiment.table.supply_v
        weights = np.array([drill.importance for drill in self.drills])
        weighted = weights[:, None] * relative_costs(found, self.scale, supply, self.limits, self.swings)
        return combine_plants(weighted.sum(axis=2) / weights.sum(), self.limits.worst_plant_share)


def relative_costs(
    found: FollowingErrors,
    scale: ErrorScale,
    supply_v: float,
    limits: CostLimits = TUNING_LIMITS.cost,
    swings: SwingBounds = SWING_BOUNDS,
) -> Floats:
    """The cost of every class: (n, plants, classes, 4)."""
    louder = np.maximum(found.rattle - np.maximum(scale.rattle, limits.unheard_rad), 0.0)
    # One joint may come out a little below its floor, where a neighbour carries it.
    avoidable = np.maximum(found.error - scale.floor, 0.0)
    length = avoidable + limits.rattle_weight * (found.rattle + limits.louder_weight * louder)
    unbearable = np.maximum(found.chatter / swings.chatter_moving_hz - limits.bearable_share, 0.0)
    shaking = np.maximum(found.rattle / swings.rattle_moving_rad - limits.bearable_share, 0.0)
    share = length / scale.room + limits.chatter_weight * unbearable + limits.shaking_weight * shaking
    return np.sqrt(share + limits.effort_weight * found.volts / supply_v)


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
    shape = (len(controllers), len(plants), JOINTS)
    kept: list[list[Floats]] = [[], [], [], []]
    for drill in drills:
        run = drill.experiment.run_exact if exact else drill.experiment.run
        result = run(laws, arms, every=1, threads=threads)
        for place, value in enumerate(_measures(drill, result, limits)):
            kept[place].append(value.reshape(shape))
    return FollowingErrors(*(np.stack(values, axis=2) for values in kept))


def _measures(drill: TrainingMotion, result: Result, limits: CostLimits) -> tuple[Floats, Floats, Floats, Floats]:
    """Error, volts, rattling and chatter (n k, 4) of one motion."""
    experiment = drill.experiment
    error = error_of(result.itae / drill.total_weight, result.mse, limits)
    error[result.diverged] = limits.lost_cost
    shaken = rattle(result.angles, experiment.leader, 1, WAIT_S)
    shaken[result.diverged] = limits.lost_cost
    return error, result.itau / drill.total_weight, shaken, chatter(result.duties, 1, experiment.table.board)
