"""Finds where a set on trial swings more than the one from before. The limits are those of a commissioning
(`measure/limits.py`).

A hand trembles, and a good follower follows that: only what it does beyond its leader counts as unrest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy.ndimage  # both are loaded before an arm is led, since to load one takes
import scipy.signal  # noqa: F401 # longer than the arm's lease on a small computer

from greywhale.adapt.limits import ADAPTATION_LIMITS, AdaptationLimits
from greywhale.adapt.stretch import Stretch, chains_of, traces_of
from greywhale.base.types import Floats
from greywhale.measure.limits import SWING_LIMITS, AllowedSwings, SwingLimits
from greywhale.measure.swings import chatter_of_record, rattle_of_record, ripple_of_record, unrest


@dataclass(frozen=True)
class Swings:
    """Unrest and rattle (rad rms), chatter (1/s) and ripple (V rms), (4,) each; NaN where the record shows none."""

    unrest: Floats
    rattle: Floats
    chatter: Floats
    ripple: Floats

    @classmethod
    def of(
        cls, stretches: Sequence[Stretch], supply_v: float, limits: AdaptationLimits = ADAPTATION_LIMITS
    ) -> Self | None:
        """Measured over the longest part without a gap; None where that is too short."""
        chain = max(chains_of(stretches), key=len, default=[])
        if len(chain) < limits.samples.least_swing_record_s:
            return None
        traces, still = traces_of(chain), limits.changes.still_rad
        return cls(
            unrest=_beyond(*(unrest(traces.leader, path, still) for path in (traces.follower, traces.leader))),
            rattle=rattle_of_record(traces.leader, traces.follower),
            chatter=chatter_of_record(traces.voltage, supply_v),
            ripple=ripple_of_record(traces.voltage),
        )


def find_excess(now: Swings, before: Swings, supply_v: float, limits: SwingLimits = SWING_LIMITS) -> str:
    """A clause on what is beyond its limit, "" for nothing."""
    most_of = AllowedSwings.beside(
        before.unrest[None],
        before.rattle[None],
        before.chatter[None],
        before.ripple[None],
        limits.bounds.quiet_share * supply_v,
        limits,
    )
    allowed = {
        "unrest": (most_of.unrest[0], 1e3, "mrad rms at rest"),
        "rattle": (most_of.rattle[0], 1e3, "mrad rms of rattling"),
        "chatter": (most_of.chatter[0], 1.0, "swings of the voltage a second"),
        "ripple": (most_of.ripple[0], 1.0, "V rms of ripple"),
    }
    for name, (most, unit, what) in allowed.items():
        shares = np.nan_to_num(getattr(now, name) / most)
        joint = int(np.argmax(shares))
        if shares[joint] > limits.bearable_excess:
            value = unit * getattr(now, name)[joint]
            return f"joint {joint} has {value:.3g} {what}, and {unit * most[joint]:.3g} are allowed"
    return ""


def _beyond(follower: Floats, leader: Floats) -> Floats:
    found: Floats = np.sqrt(np.maximum(follower**2 - leader**2, 0.0))
    return found
