"""What a controller costs, joint by joint, over all plants and all training motions, with the firmware's own integers.

The cost of a joint is a length (rad): the mean of |e|, weighted with time that restarts at every move of the leader,
plus EFFORT times the mean of |u| with the same weights, plus what `margins` demands. Over the plants the mean and the
worst count half each. A controller that does nothing costs the whole distance that the leader goes, some 0.5 rad; the
effort of a good one costs some thousandths.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from greywhale.simulate import Result
from greywhale.tune.training import Drill

Floats = npt.NDArray[np.float64]
Controllers = npt.NDArray[np.int32]

# rad per V: 10 V all the time cost as much as 10 mrad.
EFFORT = 1e-3
WORST_SHARE = 0.5


@dataclass(frozen=True)
class Costs:
    """A row per candidate, a column per joint, in rad."""

    error: Floats
    effort: Floats  # already times EFFORT
    penalty: Floats

    @property
    def total(self) -> Floats:
        total: Floats = self.error + self.effort + self.penalty
        return total


def combined(values: Floats) -> Floats:
    """Values (n, k, 4) over k plants to (n, 4): half the mean and half the worst."""
    mixed: Floats = (1.0 - WORST_SHARE) * values.mean(axis=1) + WORST_SHARE * values.max(axis=1)
    return mixed


def crossed(controllers: Controllers, plants: Floats) -> tuple[Controllers, Floats]:
    """Every controller with every plant: n k rows of both, the plants of one controller beside each other."""
    laws = np.repeat(controllers, len(plants), axis=0)
    arms = np.tile(plants, (len(controllers), 1))
    return np.ascontiguousarray(laws), np.ascontiguousarray(arms)


@dataclass(frozen=True)
class Objective:
    """The training motions and the plants on which candidates are judged."""

    drills: Sequence[Drill]
    plants: Floats
    threads: int = 0

    def tracking(self, controllers: Controllers, single: bool = False) -> tuple[Floats, Floats]:
        """Weighted mean of |e| (rad) and of |u| (V), each (n, plants, 4); `single`: in the bench's own arithmetic."""
        laws, arms = crossed(controllers, self.plants)
        shape = (len(controllers), len(self.plants), 4)
        error, volts, weight = np.zeros(shape), np.zeros(shape), 0.0
        for drill in self.drills:
            result = self._run(drill, laws, arms, single)
            error += result.itae.reshape(shape)
            volts += result.itau.reshape(shape)
            weight += drill.total_weight
        return error / weight, volts / weight

    def costs(self, controllers: Controllers, single: bool = False) -> tuple[Floats, Floats]:
        """Error and effort (n, 4), both in rad, over all plants."""
        error, volts = self.tracking(controllers, single)
        return combined(error), EFFORT * combined(volts)

    def _run(self, drill: Drill, laws: Controllers, arms: Floats, single: bool) -> Result:
        if single:
            return drill.experiment.run_single(laws, arms, threads=self.threads)
        return drill.experiment.run(laws, arms, threads=self.threads)
