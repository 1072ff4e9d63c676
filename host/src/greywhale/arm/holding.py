"""The voltage that a joint needs to hold still and to start against gravity and friction, over its whole range."""

from __future__ import annotations

import numpy as np

from greywhale.arm.body import Body
from greywhale.arm.plants import column, rigid_joints
from greywhale.base.types import Floats
from greywhale.protocol.firmware import JOINTS

# Gravity pulls by the cosines of the pitch angles: between two of so many steps a joint's range it changes little.
STEPS = 25


def starting_volts(plant: Floats, low: Floats, high: Floats) -> Floats:
    """(4,) V that start each joint of a plant (columns,) wherever it stands between `low` and `high`, (4,) rad.

    That is the largest torque of gravity, with the friction of the load, and the breakaway torque on top. All joints
    hold their largest torque at once, so a supply that sags does so most. A joint that is not in use needs none.
    """
    axes = [np.linspace(low[joint], high[joint], STEPS) for joint in (1, 2)]
    shoulder, wrist = (grid.ravel() for grid in np.meshgrid(*axes))
    poses = np.zeros((len(shoulder), JOINTS))
    poses[:, 1], poses[:, 2] = shoulder, wrist
    gravity = np.abs(Body.of(plant).bias(poses, np.zeros_like(poses))).max(axis=0)

    def each(name: str) -> Floats:
        return np.array([plant[column(name, joint)] for joint in range(JOINTS)])

    rigid = rigid_joints(plant)
    torque = np.where(rigid, 0.0, gravity * (1.0 + each("load_friction")) + each("breakaway"))
    volts: Floats = torque / np.where(rigid, 1.0, each("torque_per_volt"))
    supply, resistance = plant[column("supply")], plant[column("supply_resistance")]
    current = float(np.sum(volts / each("resistance") * np.minimum(1.0, volts / supply)))
    left = max(0.1, 1.0 - float(resistance) * current / float(supply))
    needed: Floats = volts / left
    return needed
