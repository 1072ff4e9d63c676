"""Tells a follower that follows its leader from one that does not; only a leader that moved enough can tell.

Where the leader moves little, friction and backlash may hold a healthy joint still, and where it moved only just now,
a healthy joint may not have answered yet.
"""

from __future__ import annotations

import numpy as np

from greywhale.base.types import Floats
from greywhale.measure.limits import FOLLOWING


def follows(leader: Floats, follower: Floats, period: float) -> bool:
    """False where the leader moved, and at no delay the error varies clearly less than the leader does.

    A constant error does not count: a joint that is off by an angle follows.
    """
    delays = [round(delay / period) for delay in FOLLOWING.delays_s]
    before = leader[: len(leader) - delays[-1]]
    if not before.size or np.ptp(before) < FOLLOWING.least_motion_rad:
        return True
    return any(_shares(leader[: len(leader) - delay], follower[delay:]) for delay in delays)


def _shares(leader: Floats, follower: Floats) -> bool:
    return bool(np.var(leader - follower) < (1.0 - FOLLOWING.least_share) * np.var(leader))
