"""The load under which an honest joint would read, and be driven, as a joint that lies.

The board knows a joint by its reading and its voltage alone. Where an honest joint with some load on it shows the same
readings at the same voltages, no check of the board can tell the two apart.
"""

from __future__ import annotations

import numpy as np

from greywhale.arm.body import Body
from greywhale.arm.plants import columns
from greywhale.base.types import Floats
from greywhale.files.arm import default_arm
from greywhale.identify import sampled_plants
from tools.attack.arm_on_board import SLICE_S, ArmOnBoard
from tools.attack.pot_lies import MIDDLE_MV, MV_PER_RAD

WINDOW = 200  # slices, 50 ms: over so long readings are smoothed before they are differentiated
MOVES_RAD_PER_S = 0.03  # a slower joint may stand, and friction then holds it as far as it can
SLIDING = 0.8  # of the friction that starts a joint, while it moves
MOST = 0.95  # of the time; the rest are moments at which smoothing is not true, such as a stop


class Watch:
    """Watches a board's readings and voltages, slice by slice."""

    def __init__(self, arm: ArmOnBoard) -> None:
        self._arm = arm
        self._readings: list[Floats] = []
        self._volts: list[Floats] = []

    def note(self) -> None:
        """The slice that has just passed."""
        _, *values = self._arm.board.outputs().tolist()
        duties, signs = np.array(values[:4]), np.where(values[4:], 1.0, -1.0)
        self._volts.append(duties * signs * self._arm.supply_v)
        self._readings.append((self._arm.millivolts[4:] - MIDDLE_MV) / MV_PER_RAD)

    def load_v(self, joint: int) -> float:
        """The load of an honest joint, in V at its motor, that 95 % of the time is not above; 0 where it was short."""
        if len(self._readings) < 6 * WINDOW:
            return 0.0
        angles = _smooth(np.array(self._readings))
        speeds = np.gradient(angles, SLICE_S, axis=0)
        accelerations = _smooth(np.gradient(_smooth(speeds), SLICE_S, axis=0))
        cut = slice(WINDOW - 1, WINDOW - 1 + len(accelerations))
        needed, friction = _needed_v(angles[cut], speeds[cut], accelerations)
        rest, speed = (needed - _smooth(np.array(self._volts))[cut])[:, joint], speeds[cut, joint]
        load = np.where(
            np.abs(speed) > MOVES_RAD_PER_S,
            rest + np.sign(speed) * SLIDING * friction[joint],
            np.maximum(np.abs(rest) - friction[joint], 0.0),
        )
        return float(np.quantile(np.abs(load), MOST))


def _smooth(values: Floats) -> Floats:
    """Means over a window, of each column, twice: shorter by two windows less two."""
    for _ in range(2):
        sums = np.vstack([np.zeros(values.shape[1]), np.cumsum(values, axis=0)])
        values = (sums[WINDOW:] - sums[:-WINDOW]) / WINDOW
    return values


def _needed_v(angles: Floats, speeds: Floats, accelerations: Floats) -> tuple[Floats, Floats]:
    """(n, 4) V that the default arm's motors need for a motion, without friction, and (4,) V that start each joint."""
    plant = sampled_plants(default_arm(), 1, 0)[0]
    inertia, damping, breakaway, per_volt = (
        plant[columns(name)] for name in ("inertia", "damping", "breakaway", "torque_per_volt")
    )
    torque = Body.of(plant).torque(angles, speeds, accelerations) + inertia * accelerations + damping * speeds
    return torque / per_volt, breakaway / per_volt
