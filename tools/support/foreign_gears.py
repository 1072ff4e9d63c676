"""Motors that MuJoCo moves apart from their joints: gears with a gap and a stiffness, feeble drivers, cogging.

The gear's equations are written out here, at a fifth of the bench's slice. Nothing of greywhale's plant takes part.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.export import mjcf
from greywhale.base.types import Floats
from greywhale.protocol.firmware import JOINTS

ROTOR = "rotor"
SUBSTEPS = 5  # of a slice: teeth in contact swing at up to 100 Hz
GRAMS = 1e-6  # kg, the least that MuJoCo takes; the rotor's inertia is its armature


@dataclass(frozen=True)
class Gears:
    """Between motors and joints, (4,) each: half of the gap (rad), stiffness (N m/rad) and damping (N m s)."""

    half_gap: Floats
    stiffness: Floats
    damping: Floats

    def torque(self, bend: Floats, speed: Floats) -> Floats:
        """Torque on the motors' sides, N m, where they are `bend` (rad) ahead of their joints at `speed` (rad/s)."""
        beyond = np.sign(bend) * np.maximum(np.abs(bend) - self.half_gap, 0.0)
        pushed = self.stiffness * beyond + np.where(beyond != 0.0, self.damping * speed, 0.0)
        return np.asarray(np.where(pushed * bend > 0.0, pushed, 0.0))  # teeth do not pull

    def pushes(self, places: Floats, speeds: Floats) -> Floats:
        """The torques (8,) on joints and motors at these places (rad) and speeds (rad/s), the joints' first."""
        (joints, motors), (joint_speeds, motor_speeds) = places.reshape(2, JOINTS), speeds.reshape(2, JOINTS)
        torque = self.torque(motors - joints, motor_speeds - joint_speeds)
        return np.concatenate([torque, -torque])


@dataclass(frozen=True)
class Drivers:
    """A voltage on its way to a motor, (4,) each: the volts lost in either direction, and cogging."""

    lost_up: Floats
    lost_down: Floats
    cogging_v: Floats
    poles: Floats  # a turn of the joint

    def volts(self, asked: Floats, angles: Floats) -> Floats:
        """The voltages that act at motors at these angles (rad)."""
        lost = np.where(asked > 0.0, self.lost_up, self.lost_down)
        acting = np.sign(asked) * np.maximum(np.abs(asked) - lost, 0.0)
        return np.asarray(acting + self.cogging_v * np.sin(self.poles * angles))


def with_rotors(parameters: ArmParameters) -> str:
    """The arm as MJCF whose motors, with their friction, are bodies of their own."""
    root = xml.fromstring(mjcf(parameters))
    (world,) = root.findall("worldbody")
    joints = {joint.get("name"): joint for joint in world.iter("joint")}
    for driver in root.findall("actuator/general"):
        joint = joints[driver.get("joint")]
        body = xml.SubElement(world, "body", name=f"{ROTOR}_{driver.get('joint')}")
        moved = {key: joint.attrib.pop(key) for key in ("armature", "damping", "frictionloss")}
        xml.SubElement(body, "joint", moved, type="hinge", axis="0 0 1", name=f"{ROTOR}_{driver.get('joint')}_turn")
        xml.SubElement(body, "inertial", pos="0 0 0", mass=repr(GRAMS), diaginertia=f"{GRAMS**2} {GRAMS**2} {GRAMS**2}")
        driver.set("joint", f"{ROTOR}_{driver.get('joint')}_turn")
    return xml.tostring(root, encoding="unicode")


def inertia_of_joints(engine: Any, parameters: ArmParameters, pose: Floats) -> Floats:
    """Inertia that each joint carries in a pose, kg m^2, without its motor."""
    model = engine.MjModel.from_xml_string(mjcf(parameters))
    model.dof_armature[:] = 0.0
    data = engine.MjData(model)
    data.qpos[:] = pose
    engine.mj_forward(model, data)
    full = np.zeros((JOINTS, JOINTS))
    for column, unit in enumerate(np.eye(JOINTS)):
        engine.mj_mulM(model, data, full[column], unit)
    return np.diag(full).copy()
