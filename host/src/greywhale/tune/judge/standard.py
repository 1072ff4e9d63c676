"""The standard for an upload: a controller holds the margins that the one from before holds, and is quiet at rest.

Softer teeth are no part of it: the softest that recordings allow, made softer still, would forbid all close following.
They cost a search something, and the report tells where they do not hold.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np
import numpy.typing as npt

from greywhale.base.types import Flags, Floats
from greywhale.protocol.firmware import JOINTS
from greywhale.tune.judge.margins import AT_REST, TEETH, Margin, Unrest
from greywhale.tune.limits import TUNING_LIMITS, ChoiceLimits, TuningLimits


@dataclass(frozen=True)
class Standard:
    """On how many plants a joint may fail each scenario (4,), as the controller from before does, and its ripple."""

    failing: Mapping[str, npt.NDArray[np.int64]]
    quiet_v: Floats  # (4,) V rms, at rest
    limits: ChoiceLimits = TUNING_LIMITS.choice

    @classmethod
    def of(
        cls,
        before: tuple[Margin, ...],
        supply_v: float,
        level: float = 1.0,
        judging: TuningLimits = TUNING_LIMITS,
    ) -> Self:
        """The ripple may be that from before or `quiet_share` of the supply, the larger one, divided by `level`."""
        failing: dict[str, npt.NDArray[np.int64]] = {}
        ripple = np.zeros(JOINTS)
        for margin in before:
            failing.setdefault(margin.scenario, np.zeros(JOINTS, np.int64))[margin.joint] = margin.plants_failing
            if margin.scenario == AT_REST:
                ripple[margin.joint] = margin.ripple_v
        return cls(failing, np.maximum(ripple, judging.swings.quiet_share * supply_v) / level, judging.choice)

    def falls_short(self, unrest: Mapping[str, Unrest], kept: Flags) -> Flags:
        """True where a joint of a candidate falls short, (n, 4); `kept` marks the joints that keep their controller."""
        most = np.where(kept, self.limits.shaken_ripple, self.limits.same_ripple)
        short: Flags = unrest[AT_REST].ripple.max(axis=1) > most * self.quiet_v
        for scenario, found in unrest.items():
            if scenario == TEETH:
                continue
            short = short | (found.fails.sum(axis=1) > self.failing.get(scenario, 0))
        return short

    def joints_short(self, margins: tuple[Margin, ...], kept: Flags) -> Flags:
        """True where a joint of one controller falls short, (4,); `kept` marks the joints that keep theirs."""
        short = np.zeros(JOINTS, dtype=bool)
        for margin in margins:
            joint, scenario = margin.joint, margin.scenario
            most = self.limits.shaken_ripple if kept[joint] else self.limits.same_ripple
            loud = scenario == AT_REST and margin.ripple_v > most * self.quiet_v[joint]
            fails = scenario != TEETH and margin.plants_failing > self.failing[scenario][joint]
            short[joint] |= loud or fails
        return short
