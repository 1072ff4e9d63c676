"""The model that follows the arm: a local fit, to the last stretches, of what drifts in an arm at work.

That is friction, what a torque, an acceleration and a speed cost in volts, and the load at the tip. Everything else
(gears, play, lag) stays as the identification found it. A fit starts at the last one, so a few steps of least squares
on half-second windows are enough; the voltages that the board gave drive it, whatever controllers gave them. A load
changes what all pitch joints feel, which joint by joint looks like weaker motors: so one fit begins with the load.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from greywhale.adapt.contradiction import find_contradiction
from greywhale.adapt.limits import ADAPTATION_LIMITS, AdaptationLimits
from greywhale.adapt.stretch import Stretch, chains_of, traces_of
from greywhale.arm import ArmParameters
from greywhale.base.types import Floats
from greywhale.files.log import Log
from greywhale.files.log.layout import Origin
from greywhale.identify.data import prepare
from greywhale.identify.samples import draw_plants
from greywhale.identify.space import MOTOR, WHOLE_ARM, Parameter, Space
from greywhale.identify.steps import WindowFit
from greywhale.identify.uncertainty import uncertainty
from greywhale.identify.windows import WindowResidual
from greywhale.protocol.firmware import JOINTS, TICK_S
from greywhale.protocol.table import ParameterTable

DRIFTS = (*MOTOR, "coulomb", "tip")
LOAD = Parameter(WHOLE_ARM, "tip")


@dataclass(frozen=True)
class LiveModel:
    """An arm whose numbers in `space` are now `x`. `plants` (k, columns): the estimate, then others as likely."""

    arm: ArmParameters
    space: Space = field(repr=False)
    x: Floats
    plants: Floats = field(repr=False)
    limits: AdaptationLimits = field(default=ADAPTATION_LIMITS, repr=False)

    @classmethod
    def of(cls, arm: ArmParameters, limits: AdaptationLimits = ADAPTATION_LIMITS) -> Self:
        """As an identification left it."""
        space = Space.of(arm, DRIFTS, arm.joints_in_use)
        x = space.start()
        return cls(arm, space, x, space.plants(x[None]), limits)

    def changes(self) -> dict[str, float]:
        """Return every number as a multiple of what the model's file says; of a load, kg more."""
        more = self.x - self.space.start()
        kinds = [self.space.kind(index) for index in range(len(self.space))]
        return {
            name: float(np.exp(one) if kind.logarithmic else one)
            for name, kind, one in zip(self.space.names, kinds, more, strict=True)
        }

    @property
    def contradiction(self) -> str:
        """The reason why the readings cannot be true, in a clause; "" where they can."""
        return find_contradiction(self.changes(), self.arm.joints_in_use, self.limits.model.max_pot_error)

    def refit(self, stretches: Sequence[Stretch], table: ParameterTable, seed: int) -> LiveModel:
        """Return the model fitted to these stretches; joints that they do not move stay as they were."""
        log, limits, usual = log_of(stretches, table), self.limits.model, self.limits.tuning.identification
        # Where a reading lies, a motor that it leads comes to the wrong place, and the lie shows less.
        unled = replace(usual, data=replace(usual.data, led_s=0.0))
        prepared = prepare(log, table["filter_shift"], unled)
        moved = np.ptp(log.follower, axis=0) > limits.moved_rad
        joints = [joint for joint in self.arm.joints_in_use if moved[joint] and prepared.runs]
        if not joints:
            return self
        windows = WindowResidual([prepared], self.arm, joints)
        zero = np.zeros(JOINTS)
        starts = (self._with_load(windows), self.x)
        tried = [WindowFit(windows, self.space, start).run(limits.fit_steps) for start in starts]
        loaded, other = (float(windows.misfit(self.space.plants(x[None])[0], zero).mean()) for x in tried)
        found = tried[0] if loaded < limits.load_preference * other else tried[1]
        # Where the windows begin in gaps and play is seen best with a model that is nearly right.
        windows.settle(self.space.plants(found[None])[0], zero)
        found = WindowFit(windows, self.space, found).run(limits.fit_steps)
        sure = uncertainty(windows, self.space, found, joints)
        others = draw_plants(self.space, found, sure.covariance, limits.plants - 1, seed)
        return replace(self, x=found, plants=np.vstack([self.space.plants(found[None]), others]))

    def _with_load(self, windows: WindowResidual) -> Floats:
        """Return the searched numbers with the load that explains the windows best."""
        place, x = self.space.names.index(LOAD.name), self.x.copy()
        x[place] = self.arm.tip.mass
        loads = Space(self.arm, (LOAD,), self.space.plants(x[None])[0])
        x[place] = WindowFit(windows, loads, self.x[[place]]).run(self.limits.model.fit_steps)[0]
        return x


def log_of(stretches: Sequence[Stretch], table: ParameterTable) -> Log:
    """Stretches as a log; where something is missing between two, its time jumps."""
    parts, times = [], []
    for chain in chains_of(stretches):
        traces = traces_of(chain)
        parts.append(traces)
        times.append(chain[0].begins_s + TICK_S * np.arange(len(traces.leader)))
    time = np.concatenate(times)
    return Log(
        name="the last stretches",
        origin=Origin("", table.board.key, table.crc, table.period_ms, 1, table, table.joints_in_use),
        time=time - time[0],
        leader=np.concatenate([one.leader for one in parts]),
        follower=np.concatenate([one.follower for one in parts]),
        voltage=np.concatenate([one.voltage for one in parts]),
        state=np.full(len(time), "following"),
        dropped=0,
        complete=True,
    )
