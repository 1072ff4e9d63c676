"""How noisy the potentiometers are that made a log: a tuner that heard no noise would choose a Kd that magnifies it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from greywhale.arm.parameters import USUAL_TRACK_RAD
from greywhale.firmware import CONVERSIONS
from greywhale.identify.data import Prepared

Floats = NDArray[np.float64]
STEPS = 1024  # of the converter


def pot_noise(log: Prepared, filter_shift: int, supply: float) -> Floats:
    """Of the follower's four potentiometers, V rms, from the log's readings.

    A reading is the sum of four conversions after the firmware's low-pass, whose variance is share / (2 - share) of
    its input's; the converter's own steps make a part of it.
    """
    share = 1.0 / (1 << filter_shift)
    conversion = log.noise**2 * CONVERSIONS * (2.0 - share) / share
    analog = np.maximum(conversion - (USUAL_TRACK_RAD / STEPS) ** 2 / 12.0, 0.0)
    noise: Floats = np.sqrt(analog) / USUAL_TRACK_RAD * supply
    return noise
