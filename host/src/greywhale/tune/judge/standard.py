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

from greywhale import _native
from greywhale.base.limits import numbers_in
from greywhale.base.types import Flags, Floats
from greywhale.protocol.firmware import JOINTS
from greywhale.tune.judge.margins import AT_REST, SCENARIOS, Margin, Unrest
from greywhale.tune.limits import TUNING_LIMITS, ChoiceLimits, TuningLimits

Counts = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Standard:
    """On how many plants a joint may fail each scenario (4,), as the controller from before does, and its ripple."""

    failing: Mapping[str, Counts]
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
        failing, ripple = _seen(before)
        swings = numbers_in(judging.swings)
        quiet = [_native.quiet_ripple(ripple_before=one, supply_v=supply_v, swings=swings) for one in ripple.tolist()]
        return cls(failing, np.array(quiet) / level, judging.choice)

    def falls_short(self, unrest: Mapping[str, Unrest], kept: Flags) -> Flags:
        """True where a joint of a candidate falls short, (n, 4); `kept` marks the joints that keep their controller."""
        failing = {scenario: found.fails.sum(axis=1) for scenario, found in unrest.items()}
        return self._short(failing, unrest[AT_REST].ripple.max(axis=1), kept)

    def joints_short(self, margins: tuple[Margin, ...], kept: Flags) -> Flags:
        """True where a joint of one controller falls short, (4,); `kept` marks the joints that keep theirs."""
        failing, ripple = _seen(margins)
        short: Flags = self._short({name: row[None] for name, row in failing.items()}, ripple[None], kept[None])[0]
        return short

    def _short(self, failing: Mapping[str, Counts], ripple_v: Floats, kept: Flags) -> Flags:
        """Candidates (n, 4) by the plants on which each joint fails in each scenario, and the worst ripple at rest."""
        may_fail = [self.failing.get(name, np.zeros(JOINTS)) for name in failing]
        short = _native.falls_short(
            scenarios=[SCENARIOS.index(name) for name in failing],
            failing=np.array(list(failing.values()), np.float64).reshape(len(failing), *ripple_v.shape),
            ripple_v=ripple_v,
            may_fail=np.array(may_fail, np.float64).reshape(len(failing), JOINTS),
            quiet_v=self.quiet_v.tolist(),
            kept=np.ascontiguousarray(kept),
            choice=numbers_in(self.limits),
        )
        return np.asarray(short)


def hunting_everywhere(margins: tuple[Margin, ...]) -> Flags:
    """True where a joint comes to rest on no plant at all, (4,)."""
    found = np.zeros(JOINTS, dtype=bool)
    for margin in margins:
        if margin.scenario == AT_REST:
            found[margin.joint] = margin.plants_failing == margin.plants
    return found


def _seen(margins: tuple[Margin, ...]) -> tuple[dict[str, Counts], Floats]:
    """On how many plants each joint fails in each scenario, and its ripple at rest: (4,) each."""
    failing: dict[str, Counts] = {}
    ripple = np.zeros(JOINTS)
    for margin in margins:
        failing.setdefault(margin.scenario, np.zeros(JOINTS, np.int64))[margin.joint] = margin.plants_failing
        if margin.scenario == AT_REST:
            ripple[margin.joint] = margin.ripple_v
    return failing, ripple
