"""What a controller costs, joint by joint, over all plants and training motions, with the firmware's own integers.

The cost of a joint is a length (rad), the sum of

- the mean of |e|, weighted with time that restarts at every move of the leader (`training.time_since_move`);
- RMS times the root of the mean of e^2, without weights: this is what the paper's tables measure, and it arises mostly
  during moves;
- EFFORT times the mean of |u|, weighted like |e|;
- the price that `margins` sets for a joint that does not come to rest.

The mean over the plants counts half, and the worst plant the other half. A controller that does nothing costs the whole
distance that the leader goes, some 1 rad; the effort of a good one costs a thousandth of that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from greywhale.loop import Result
from greywhale.tune.search.training import Drill

Floats = npt.NDArray[np.float64]
Controllers = npt.NDArray[np.int32]

# rad per V: 10 V all the time costs as much as 10 mrad.
EFFORT = 1e-3
RMS = 1.5
WORST_SHARE = 0.5


def combine_plants(values: Floats) -> Floats:
    """Combine values (n, k, 4) over k plants to (n, 4): half the mean and half the worst."""
    mixed: Floats = (1.0 - WORST_SHARE) * values.mean(axis=1) + WORST_SHARE * values.max(axis=1)
    return mixed


def pair_with_plants(controllers: Controllers, plants: Floats) -> tuple[Controllers, Floats]:
    """Pair every controller with every plant: n k rows of both, the plants of one controller beside each other."""
    laws = np.repeat(controllers, len(plants), axis=0)
    arms = np.tile(plants, (len(controllers), 1))
    return np.ascontiguousarray(laws), np.ascontiguousarray(arms)


@dataclass(frozen=True)
class Tracking:
    """(n, plants, 4) each."""

    error: Floats  # rad, weighted mean of |e|
    square: Floats  # rad2, mean of e^2
    volts: Floats  # V, weighted mean of |u|


@dataclass(frozen=True)
class Objective:
    """The training motions and the plants on which candidates are judged."""

    drills: Sequence[Drill]
    plants: Floats
    threads: int = 0

    def tracking(self, controllers: Controllers, single: bool = False) -> Tracking:
        """Simulate every candidate on every plant; `single`: in the bench's own arithmetic."""
        laws, arms = pair_with_plants(controllers, self.plants)
        shape = (len(controllers), len(self.plants), 4)
        error, square, volts = np.zeros(shape), np.zeros(shape), np.zeros(shape)
        for drill in self.drills:
            result = self._run(drill, laws, arms, single)
            error += result.itae.reshape(shape)
            volts += result.itau.reshape(shape)
            square += drill.experiment.ticks * result.mse.reshape(shape)
        weight = sum(drill.total_weight for drill in self.drills)
        return Tracking(error / weight, square / sum(drill.experiment.ticks for drill in self.drills), volts / weight)

    def costs(self, controllers: Controllers, single: bool = False) -> Floats:
        """(n, 4) in rad, over all plants; without the price of unrest."""
        found = self.tracking(controllers, single)
        return combine_plants(found.error + RMS * np.sqrt(found.square) + EFFORT * found.volts)

    def _run(self, drill: Drill, laws: Controllers, arms: Floats, single: bool) -> Result:
        if single:
            return drill.experiment.run_single(laws, arms, threads=self.threads)
        return drill.experiment.run(laws, arms, threads=self.threads)
