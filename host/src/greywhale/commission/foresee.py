"""Predicts errors on steps by a round's model. No check has any: a host leads slower than a leader can be thrown.

The model predicts how a controller's error on steps compares with that of the controller from before. On arms of
another engine these ratios came out within 0.015, and near 1 within 0.007, of what the arm then did. So a joint that
should follow steps worse does not pass, however well it does in the check; unless its neighbours' quicker moves are the
reason, and its controller from before would do worse still. A joint whose model is wrong about quick moves is not
judged by it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.plants import plant_row
from greywhale.base.types import Controllers, Flags, Floats
from greywhale.commission.limits import COMMISSIONING_LIMITS, CommissioningLimits, StepLimits
from greywhale.commission.measures import Measures, measure
from greywhale.commission.motions import PARTS, Check
from greywhale.loop import Experiment, multi_steps
from greywhale.loop.controllers import controllers_of
from greywhale.loop.led_model import predict
from greywhale.loop.traces import Traces
from greywhale.measure.swings import most_unrest
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import ParameterTable
from greywhale.tune.search.training import clip_motion, reach

SEED = 7  # of the noise
LEAST = 1e-12  # rad², the error of a joint that is not in use


@dataclass(frozen=True)
class Foresight:
    """Errors of the controllers from before on steps, by a model; `believed` (4,) marks the joints that it knows."""

    experiment: Experiment
    plant: Floats
    before: Controllers
    error: Floats  # (4,) rad²
    believed: Flags
    limits: StepLimits = COMMISSIONING_LIMITS.steps

    def ratios(self, rows: Controllers) -> Floats:
        """(4,): each joint's error on steps with controllers (4, 13), as a share of that before."""
        found: Floats = self.experiment.run_exact(rows[None], self.plant).mse[0] / np.maximum(self.error, LEAST)
        return found

    def estimate(self, rows: Controllers, worse: Floats) -> tuple[Floats, Floats]:
        """Return the ratios (n, 4) of many controllers (n, 4, 13), in single precision, and the most unrest (2, n, 4)
        between two steps, rad rms, on the model and on a `worse` arm (1, columns).
        """
        known, other = (self.experiment.run(rows, plant, every=1) for plant in (self.plant, worse))
        restless = [
            [np.nan_to_num(most_unrest(self.experiment.leader, angles.astype(np.float64))) for angles in found.angles]
            for found in (known, other)
        ]
        return known.mse / np.maximum(self.error, LEAST), np.array(restless)

    def clauses(self, rows: Controllers) -> tuple[str, ...]:
        """(4): what speaks against each joint's controller, "" for nothing; a controller from before always passes."""
        changed = (rows != self.before).any(axis=1)
        ratios = self.ratios(rows)
        suspects = changed & self.believed & (ratios > self.limits.max_error_share)
        return tuple(
            f"by the model, it follows steps worse than before ({ratios[joint]:.3g} times the error)"
            if suspects[joint] and not self._is_better_than_before(rows, joint, float(ratios[joint]))
            else ""
            for joint in range(JOINTS)
        )

    def _is_better_than_before(self, rows: Controllers, joint: int, ratio: float) -> bool:
        """True where the joint's own controller from before would do worse beside these neighbours."""
        reverted = rows.copy()
        reverted[joint] = self.before[joint]
        return ratio < float(self.ratios(reverted)[joint])


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
    plant, before = plant_row(arm)[None], controllers_of(table)
    motion = clip_motion(multi_steps(), *reach(arm, table, plant, judging.tuning.training))
    experiment = Experiment(motion, arm, table=table, seed=SEED)
    found = experiment.run_exact(before[None], plant, every=1)
    return Foresight(experiment, plant, before, found.mse[0], believed, judging.steps)
