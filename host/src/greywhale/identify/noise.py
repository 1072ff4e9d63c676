"""How noisy the potentiometers are that made a log: a tuner that heard no noise would choose a Kd that magnifies it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from greywhale.identify.data import Prepared

Floats = NDArray[np.float64]
CONVERSIONS = 4  # that the firmware adds up in a tick
TRACK = math.radians(300.0)  # rad, from end to end
STEPS = 1024  # of the converter


def pot_noise(log: Prepared, filter_shift: int, supply: float) -> Floats:
    """Of the follower's four potentiometers, V rms, from the log's readings.

    A reading is the sum of four conversions after the firmware's low-pass, whose variance is share / (2 - share) of
    its input's; the converter's own steps make a part of it.
    """
    share = 1.0 / (1 << filter_shift)
    conversion = log.noise**2 * CONVERSIONS * (2.0 - share) / share
    noise: Floats = np.sqrt(np.maximum(conversion - (TRACK / STEPS) ** 2 / 12.0, 0.0)) / TRACK * supply
    return noise
