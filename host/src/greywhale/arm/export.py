"""The arm in the formats of other physics engines: URDF and MuJoCo's MJCF. z is up there, as usual.

Link 3's inertias about y and z are averaged, as in greywhale's own equations, and the tip mass is merged into link 3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from xml.etree import ElementTree as xml

from greywhale.arm.parameters import ArmParameters

LINK_NAMES = ("base", "upper_arm", "wrist", "hand")
JOINT_IDS = ("base_yaw", "shoulder_pitch", "wrist_pitch", "wrist_roll")
_AXES = ((0, 1, 0), (0, 0, 1), (0, 0, 1), (1, 0, 0))


@dataclass(frozen=True)
class _Body:
    """One link in its own frame: the joint at the origin, x along the link (y for link 0, which stands upright)."""

    origin: tuple[float, float, float]  # of its joint in the frame of the link before
    centre: tuple[float, float, float]
    mass: float
    inertia: tuple[float, float, float]


def urdf(parameters: ArmParameters) -> str:
    """The arm as URDF; joint limits are the stops, effort and velocity what the motor gives at the full supply.

    Joints that are not in use are fixed ones.
    """
    robot = xml.Element("robot", name=parameters.name)
    xml.SubElement(robot, "link", name="world")
    parent = "world"
    for index, body in enumerate(_bodies(parameters)):
        link = xml.SubElement(robot, "link", name=LINK_NAMES[index])
        inertial = xml.SubElement(link, "inertial")
        xml.SubElement(inertial, "origin", xyz=_text(body.centre), rpy="0 0 0")
        xml.SubElement(inertial, "mass", value=repr(body.mass))
        xx, yy, zz = map(repr, body.inertia)
        xml.SubElement(inertial, "inertia", ixx=xx, ixy="0", ixz="0", iyy=yy, iyz="0", izz=zz)

        kind = "fixed" if parameters.joint[index].fixed else "revolute"
        joint = xml.SubElement(robot, "joint", name=JOINT_IDS[index], type=kind)
        xml.SubElement(joint, "parent", link=parent)
        xml.SubElement(joint, "child", link=LINK_NAMES[index])
        upright = (math.pi / 2, 0.0, 0.0) if index == 0 else (0.0, 0.0, 0.0)
        xml.SubElement(joint, "origin", xyz=_text(body.origin), rpy=_text(upright))
        if not parameters.joint[index].fixed:
            _add_turning(joint, parameters, index)
        parent = LINK_NAMES[index]
    return _document(robot)


def _add_turning(joint: xml.Element, parameters: ArmParameters, index: int) -> None:
    """Axis, limits and friction of a URDF's joint."""
    xml.SubElement(joint, "axis", xyz=_text(_AXES[index]))
    actuator = parameters.actuator(index)
    effort = actuator.torque_per_volt * parameters.drive.supply
    stops = parameters.joint[index].stops
    xml.SubElement(
        joint,
        "limit",
        lower=repr(stops.min),
        upper=repr(stops.max),
        effort=repr(effort),
        velocity=repr(effort / actuator.damping),
    )
    friction = parameters.joint[index].friction.coulomb
    xml.SubElement(joint, "dynamics", damping=repr(actuator.damping), friction=repr(friction))


def mjcf(parameters: ArmParameters, motors: bool = False) -> str:
    """The arm as MJCF: the links alone, or with motors driven in volts (rigid gears, Coulomb friction, no stops).

    The link of a joint that is not in use is welded to the one before: it has no joint.
    """
    model = xml.Element("mujoco", model=parameters.name)
    xml.SubElement(model, "compiler", angle="radian")
    xml.SubElement(model, "option", gravity=_text((0.0, 0.0, -parameters.gravity)))
    parent = xml.SubElement(model, "worldbody")
    for index, body in enumerate(_bodies(parameters)):
        frame = {"name": LINK_NAMES[index], "pos": _text(body.origin)}
        if index == 0:
            frame["euler"] = _text((math.pi / 2, 0.0, 0.0))
        parent = xml.SubElement(parent, "body", frame)
        joint = {"name": JOINT_IDS[index], "type": "hinge", "axis": _text(_AXES[index])}
        if motors:
            actuator = parameters.actuator(index)
            joint["armature"] = repr(actuator.inertia)
            joint["damping"] = repr(actuator.damping)
            joint["frictionloss"] = repr(parameters.joint[index].friction.coulomb)
        if index in parameters.joints_in_use:
            xml.SubElement(parent, "joint", joint)
        inertia = _text(body.inertia)
        xml.SubElement(parent, "inertial", pos=_text(body.centre), mass=repr(body.mass), diaginertia=inertia)
    if motors:
        actuators = xml.SubElement(model, "actuator")
        for index in parameters.joints_in_use:
            name = JOINT_IDS[index]
            gear = parameters.actuator(index).torque_per_volt
            supply = parameters.drive.supply
            xml.SubElement(
                actuators, "motor", joint=name, gear=repr(gear), ctrllimited="true", ctrlrange=_text((-supply, supply))
            )
    return _document(model)


def _bodies(parameters: ArmParameters) -> list[_Body]:
    link0, link1, link2, link3 = parameters.link
    tip = parameters.tip.mass
    mass3 = link3.mass + tip
    centre3 = (link3.mass * link3.centre + tip * link3.length) / mass3
    spread = link3.mass * tip / mass3 * (link3.length - link3.centre) ** 2
    across = (link3.inertia.yy + link3.inertia.zz) / 2 + spread

    def principal(index: int) -> tuple[float, float, float]:
        inertia = parameters.link[index].inertia
        return (inertia.xx, inertia.yy, inertia.zz)

    return [
        _Body((0.0, 0.0, 0.0), (0.0, link0.centre, 0.0), link0.mass, principal(0)),
        _Body((0.0, link0.length, 0.0), (link1.centre, 0.0, 0.0), link1.mass, principal(1)),
        _Body((link1.length, 0.0, 0.0), (link2.centre, 0.0, 0.0), link2.mass, principal(2)),
        _Body((link2.length, 0.0, 0.0), (centre3, 0.0, 0.0), mass3, (link3.inertia.xx, across, across)),
    ]


def _text(values: tuple[float, ...]) -> str:
    return " ".join(repr(value) for value in values)


def _document(root: xml.Element) -> str:
    xml.indent(root)
    return xml.tostring(root, encoding="unicode") + "\n"
