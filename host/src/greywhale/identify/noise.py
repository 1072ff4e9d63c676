"""Measures a log's potentiometer noise: a tuner that knows of none would choose a Kd that magnifies it."""

from __future__ import annotations

import numpy as np

from greywhale.arm.parameters import USUAL_TRACK_RAD
from greywhale.base.types import Floats
from greywhale.identify.data import Prepared
from greywhale.protocol.firmware import CONVERSIONS

STEPS = 1024  # of the converter


def pot_noise(log: Prepared, filter_shift: int, supply: float) -> Floats:
    """The noise of the follower's four potentiometers, V rms, from the log's readings.

    A reading is the sum of four conversions after the firmware's low-pass. The low-pass leaves share / (2 - share) of
    its input's variance. The converter's own steps make a part of the noise.
    """
    share = 1.0 / (1 << filter_shift)
    conversion = log.noise**2 * CONVERSIONS * (2.0 - share) / share
    analog = np.maximum(conversion - (USUAL_TRACK_RAD / STEPS) ** 2 / 12.0, 0.0)
    return np.sqrt(analog) / USUAL_TRACK_RAD * supply
