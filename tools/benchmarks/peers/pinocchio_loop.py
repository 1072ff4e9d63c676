"""The arm in Pinocchio from Python: forward dynamics at 1 ms under a proportional voltage.

The fuzzy law is left out, for in plain Python it would take most of the time.
"""

from __future__ import annotations

import time

import numpy as np
import pinocchio  # type: ignore[import-not-found,import-untyped,unused-ignore]

from greywhale.arm import ArmParameters
from greywhale.arm.export import urdf

DT = 1e-3


def ticks_per_second(parameters: ArmParameters, ticks: int = 20_000) -> float:
    """Steps of the arm alone."""
    model = pinocchio.buildModelFromXML(urdf(parameters))
    model.armature = np.array([parameters.actuator(joint).inertia for joint in range(4)])
    damping = np.array([parameters.actuator(joint).damping for joint in range(4)])
    push = np.array([parameters.actuator(joint).torque_per_volt for joint in range(4)])
    data = model.createData()
    q, v, goal = np.zeros(4), np.zeros(4), np.array([0.3, 0.2, -0.2, 0.4])
    start = time.perf_counter()
    for _ in range(ticks):
        torque = push * np.clip(15.0 * (goal - q), -15.0, 15.0) - damping * v
        v += DT * pinocchio.aba(model, data, q, v, torque)
        q += DT * v
    return ticks / (time.perf_counter() - start)
