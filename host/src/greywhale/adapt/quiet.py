"""Whether a set on trial swings more than the one from before. The limits are those of a commissioning.

A hand trembles, and a good follower follows that: only what it does beyond its leader counts as unrest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy.ndimage  # both are loaded before an arm is led, since to load one takes
import scipy.signal  # noqa: F401 # longer than the arm's lease on a small computer

from greywhale.adapt.stretch import Stretch, chains_of, traces_of
from greywhale.base.types import Floats
from greywhale.commission.judge import BEARABLE, Limits
from greywhale.commission.measures import NAMES, Measures
from greywhale.commission.motions import PARTS
from greywhale.measure.swings import QUIET_SHARE, chatter_of_record, rattle_of_record, ripple_of_record, unrest
from greywhale.protocol.firmware import JOINTS

# A hand trembles; its leader rests within this (rad).
STILL_RAD = 0.02
# Shorter records (in stretches) say little about swings.
SHORTEST = 4


@dataclass(frozen=True)
class Swings:
    """Unrest and rattle (rad rms), chatter (1/s) and ripple (V rms), (4,) each; NaN where the record shows none."""

    unrest: Floats
    rattle: Floats
    chatter: Floats
    ripple: Floats

    @classmethod
    def of(cls, stretches: Sequence[Stretch], supply_v: float) -> Self | None:
        """Measured over the longest part without a gap; None where that is too short."""
        chain = max(chains_of(stretches), key=len, default=[])
        if len(chain) < SHORTEST:
            return None
        traces = traces_of(chain)
        return cls(
            unrest=_beyond(*(unrest(traces.leader, path, STILL_RAD) for path in (traces.follower, traces.leader))),
            rattle=rattle_of_record(traces.leader, traces.follower),
            chatter=chatter_of_record(traces.voltage, supply_v),
            ripple=ripple_of_record(traces.voltage),
        )


def find_excess(now: Swings, before: Swings, supply_v: float) -> str:
    """A clause on what is beyond its limit, "" for nothing."""
    limits = Limits.of(_as_measures(before), np.zeros(JOINTS, dtype=bool), QUIET_SHARE * supply_v)
    allowed = {
        "unrest": (limits.unrest[0], 1e3, "mrad rms at rest"),
        "rattle": (limits.rattle[0], 1e3, "mrad rms of rattling"),
        "chatter": (limits.chatter[0], 1.0, "swings of the voltage a second"),
        "ripple": (limits.ripple[0], 1.0, "V rms of ripple"),
    }
    for name, (most, unit, what) in allowed.items():
        shares = np.nan_to_num(getattr(now, name) / most)
        joint = int(np.argmax(shares))
        if shares[joint] > BEARABLE:
            value = unit * getattr(now, name)[joint]
            return f"joint {joint} has {value:.3g} {what}, and {unit * most[joint]:.3g} are allowed"
    return ""


def _beyond(follower: Floats, leader: Floats) -> Floats:
    found: Floats = np.sqrt(np.maximum(follower**2 - leader**2, 0.0))
    return found


def _as_measures(swings: Swings) -> Measures:
    """A check all of whose parts are alike, as the commissioning's limits take it."""
    return Measures(**{name: np.tile(getattr(swings, name, np.zeros(JOINTS)), (len(PARTS), 1)) for name in NAMES})
