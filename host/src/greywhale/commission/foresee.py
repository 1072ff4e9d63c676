"""Predicts errors on steps by a round's model. No check has any: a host leads slower than a leader can be thrown.

The model predicts how a controller's error on steps compares with that of the controller from before. On arms of
another engine these ratios came out within 0.015, and near 1 within 0.007, of what the arm then did. So a joint that
should follow steps worse does not pass, however well it does in the check; unless its neighbours' quicker moves are the
reason, and its controller from before would do worse still. A joint whose model is wrong about quick moves is not
judged by it.

It also says whether a set would come to rest after steps, on the model and on an arm that is worse in all that decides
it. A set put together from joints of different trials was never searched as a whole: joints that rest in their own
sets may swing together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.plants import columns, plant_row
from greywhale.base.types import Controllers, Flags, Floats
from greywhale.commission.limits import COMMISSIONING_LIMITS, CommissioningLimits
from greywhale.commission.measures import Measures, measure
from greywhale.commission.motions import PARTS, Check
from greywhale.identify import loosen_gears
from greywhale.loop import Experiment, multi_steps
from greywhale.loop.controllers import controllers_of
from greywhale.loop.led_model import predict
from greywhale.loop.traces import Traces
from greywhale.measure.swings import most_unrest
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import ParameterTable
from greywhale.tune.judge.margins import with_gain
from greywhale.tune.search.training import clip_motion, reach

SEED = 7  # of the noise
LEAST = 1e-12  # rad², the error of a joint that is not in use


@dataclass(frozen=True)
class Foresight:
    """Errors and unrest of the controllers from before on steps, by a model; `believed` (4,) marks the joints that it
    knows.
    """

    experiment: Experiment
    plant: Floats  # (1, columns)
    worse: Floats  # (1, columns), an arm on which controllers come to rest less easily
    before: Controllers
    error: Floats  # (4,) rad²
    unrest: Floats  # (2, 4) rad rms, between two steps, on the model and on the worse arm
    believed: Flags
    judging: CommissioningLimits = COMMISSIONING_LIMITS

    def ratios(self, rows: Controllers) -> Floats:
        """(4,): each joint's error on steps with controllers (4, 13), as a share of that before."""
        found: Floats = self.experiment.run_exact(rows[None], self.plant).mse[0] / np.maximum(self.error, LEAST)
        return found

    def estimate(self, rows: Controllers) -> tuple[Floats, Floats]:
        """Return the ratios (n, 4) of many controllers (n, 4, 13), in single precision, and the most unrest (2, n, 4)
        between two steps, rad rms, on the model and on the worse arm.
        """
        errors, unrest = _play(self.experiment, rows, self.plant, self.worse)
        return errors / np.maximum(self.error, LEAST), unrest

    def beyond_rest(self, rows: Controllers) -> Floats:
        """(n, 4) of controllers (n, 4, 13): the unrest between two steps, rad rms, where it is more than anybody sees
        and more than before, else 0.
        """
        _, unrest = self.estimate(rows)
        most = np.maximum(self.unrest, self.judging.swings.max_unrest_rad)[:, None]
        beyond: Floats = np.where(unrest > most, unrest, 0.0).max(axis=0)
        return beyond

    def clauses(self, rows: Controllers) -> tuple[str, ...]:
        """(4): what speaks against each joint's controller, "" for nothing; a controller from before always passes."""
        changed = (rows != self.before).any(axis=1)
        ratios = self.ratios(rows)
        suspects = changed & self.believed & (ratios > self.judging.steps.max_error_share)
        swings, own = self._own_swings(rows)
        return tuple(
            f"by the model, it follows steps worse than before ({ratios[joint]:.3g} times the error)"
            if suspects[joint] and not self._is_better_than_before(rows, joint, float(ratios[joint]))
            else f"by the model, it may swing after quick moves ({1e3 * swings[joint]:.1f} mrad rms)"
            if own[joint]
            else ""
            for joint in range(JOINTS)
        )

    def _is_better_than_before(self, rows: Controllers, joint: int, ratio: float) -> bool:
        """True where the joint's own controller from before would do worse beside these neighbours."""
        return ratio < float(self.ratios(self._reverted(rows, joint))[joint])

    def _own_swings(self, rows: Controllers) -> tuple[Floats, Flags]:
        """(4,) each: what `beyond_rest` gives, and where the joint would come to rest with its controller from before
        beside these neighbours.
        """
        sets = np.stack([rows, *(self._reverted(rows, joint) for joint in range(JOINTS))])
        swings = self.beyond_rest(sets)
        return swings[0], (swings[0] > 0.0) & (np.diagonal(swings[1:]) == 0.0)

    def _reverted(self, rows: Controllers, joint: int) -> Controllers:
        """The set with one joint's controller from before."""
        reverted = rows.copy()
        reverted[joint] = self.before[joint]
        return reverted


def _play(experiment: Experiment, rows: Controllers, *plants: Floats) -> tuple[Floats, Floats]:
    """The errors (n, 4) of controllers (n, 4, 13) on the first of plants, rad², and the most unrest between two steps
    on each, (plants, n, 4) rad rms.
    """
    results = [experiment.run(rows, plant, every=1) for plant in plants]
    unrest = [
        [np.nan_to_num(most_unrest(experiment.leader, angles.astype(np.float64))) for angles in result.angles]
        for result in results
    ]
    return results[0].mse, np.array(unrest)


def foresee(
    arm: ArmParameters,
    table: ParameterTable,
    check: Check,
    traces: Traces,
    measured: Measures,
    judging: CommissioningLimits = COMMISSIONING_LIMITS,
) -> Foresight:
    """Make a model of this arm ready to predict steps; `traces` and `measured` are those of the check before, with
    `table`. The steps go wherever the board's limits let the arm go: after the commissioning a hand will.
    """
    moves = PARTS.index("moves")
    predicted = measure(predict(arm, table, traces)[0], check, table.supply_v).error[moves]
    believed = np.abs(predicted / np.maximum(measured.error[moves], LEAST) - 1.0) <= judging.steps.believed_share
    plant, worse, before = plant_row(arm)[None], worsen(arm, judging)[None], controllers_of(table)
    motion = clip_motion(multi_steps(), *reach(arm, table, plant, judging.tuning.training))
    experiment = Experiment(motion, arm, table=table, seed=SEED)
    error = experiment.run_exact(before[None], plant).mse[0]
    unrest = _play(experiment, before[None], plant, worse)[1][:, 0]
    return Foresight(experiment, plant, worse, before, error, unrest, believed, judging)


def worsen(arm: ArmParameters, judging: CommissioningLimits) -> Floats:
    """Return a plant (columns,) of this arm on which a controller comes to rest less easily. Gaps beside play are wider
    by what estimates are off on foreign arms: at the edge of a limit cycle a set passes the check, and hunts after the
    next quick move.
    """
    loose, wanted = loosen_gears(arm, judging.search.gear_sigmas), judging.search
    worse: Floats = with_gain(loose[None], wanted.worse_gain)[0]
    worse[columns("pot_lag")] += wanted.worse_lag_s
    wider = judging.tuning.identification.uncertainty.gap_beside_play_rad
    beside = (worse[columns("stiffness")] > 0.0) & (worse[columns("pot_play")] > 0.0)
    worse[columns("half_gap")] += np.where(beside, wider, 0.0)
    return worse
