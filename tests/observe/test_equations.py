"""The observer's equations against the plant's: what no motor, gravity or other link does comes from outside."""

from __future__ import annotations

import numpy as np

from greywhale import _native
from greywhale.arm import Arm, ArmParameters
from greywhale.arm.plants import plant_row
from greywhale.base.limits import numbers_in
from greywhale.files.arm import load_arm
from greywhale.observe.limits import TORQUE_LIMITS


def bare(arm: ArmParameters) -> ArmParameters:
    """The arm without friction and gaps, in a supply that sags."""
    data = arm.model_dump()
    for joint in data["joint"]:
        joint["friction"] = {}
        joint["gear"] = {}
    data["drive"]["supply_resistance"] = 0.2
    return ArmParameters.model_validate(data, strict=False)


def test_the_equations_are_the_plants() -> None:
    """All joints turn at once, with gravity and each other's inertia; the plant knows the outside torque."""
    arm = bare(load_arm("default"))
    plant = Arm(arm, longest_step_s=1e-4)
    plant.reset(np.array([0.1, 0.4, -0.3, 0.2]))
    outside = np.array([0.2, -1.0, 0.5, 0.1])
    time, angles, volts = np.arange(800) / 1000, np.zeros((800, 4)), np.zeros((800, 4))
    for row, now in enumerate(time):
        angles[row] = plant.angles
        volts[row] = np.array([4.0, 5.0, 4.0, 5.0]) * np.sin(2 * np.pi * np.array([1.0, 0.8, 1.2, 1.5]) * now + 0.5)
        plant.set_load(outside if now > 0.4 else np.zeros(4))
        plant.step(volts[row], 1e-3)
    observer = _native.TorqueObserver(plant_row(arm)[None], numbers_in(TORQUE_LIMITS), [0.0] * 4, 0.0)
    torque, *_ = observer.feed(time, angles, volts)
    stall = np.array([arm.actuator(joint).torque_per_volt * arm.drive.supply for joint in range(4)])
    assert np.ptp(angles, axis=0).min() > 0.3, "every joint must move for this to say anything"
    assert np.abs(angles).max() < 2.5, "a stop would push too"
    assert np.abs(torque[100:400] / stall).max() < 0.01
    assert np.abs((torque[530:] - outside) / stall).max() < 0.01
