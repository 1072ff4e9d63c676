"""The arm in the formats of other physics engines: URDF and MuJoCo's MJCF. z is up there, as usual.

Link 3's inertias about y and z are averaged, as in greywhale's own equations, and the tip mass is merged into link 3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from xml.etree import ElementTree as xml

import numpy as np

from greywhale.arm.doubt import doubt_of
from greywhale.arm.parameters import ArmParameters, Link
from greywhale.arm.plant import LONGEST_STEP_S, Arm
from greywhale.arm.plants import COLUMNS, Plants

LINK_NAMES = ("base", "upper_arm", "wrist", "hand")
JOINT_IDS = ("base_yaw", "shoulder_pitch", "wrist_pitch", "wrist_roll")
_AXES = ((0, 1, 0), (0, 0, 1), (0, 0, 1), (1, 0, 0))  # of the joints
# MuJoCo's friction and stops are soft; this is as stiff as it takes them at that step.
_STIFF = {
    "solreffriction": "0.0005 1",
    "solimpfriction": "0.9999 0.9999 0.001 0.5 2",
    "solreflimit": "0.0005 1",
    "solimplimit": "0.9999 0.9999 0.001 0.5 2",
}
_TEETH_IMPEDANCE = 1e-3
_STOPS = {key: _STIFF[key] for key in ("solreflimit", "solimplimit")}
_SURE: Plants = np.zeros((0, COLUMNS))  # no plants but the arm itself
_RODS = "Each link is drawn as a rod of its length, its mass and its inertia about its own line."


@dataclass(frozen=True)
class _Body:
    """One link in its own frame: the joint at the origin, x along the link (y for link 0, which stands upright)."""

    origin: tuple[float, float, float]  # of its joint in the frame of the link before
    centre: tuple[float, float, float]
    mass: float
    inertia: tuple[float, float, float]
    end: tuple[float, float, float]  # where the next joint is, or the tip
    radius: float  # of a rod of its mass with its inertia about its line


def urdf(parameters: ArmParameters, drawn: Plants = _SURE) -> str:
    """The arm as URDF; joint limits are the stops, effort and velocity what the motor gives at the full supply.

    A comment names what is missing. Joints that are not in use are fixed ones. `drawn` plants (n, columns), which the
    logs allow as well, give each joint a comment with intervals.
    """
    robot = xml.Element("robot", name=parameters.name.removesuffix(", identified"))  # it holds too little of that
    robot.append(xml.Comment(f" {_RODS} {_left_out(parameters, 'inertia of the motors')} "))
    xml.SubElement(robot, "link", name="world")
    parent = "world"
    for index, body in enumerate(_bodies(parameters)):
        link = xml.SubElement(robot, "link", name=LINK_NAMES[index])
        inertial = xml.SubElement(link, "inertial")
        xml.SubElement(inertial, "origin", xyz=_text(body.centre), rpy="0 0 0")
        xml.SubElement(inertial, "mass", value=repr(body.mass))
        xx, yy, zz = map(repr, body.inertia)
        xml.SubElement(inertial, "inertia", ixx=xx, ixy="0", ixz="0", iyy=yy, iyz="0", izz=zz)
        _add_rod(link, body)

        kind = "fixed" if parameters.joint[index].fixed else "revolute"
        joint = xml.SubElement(robot, "joint", name=JOINT_IDS[index], type=kind)
        xml.SubElement(joint, "parent", link=parent)
        xml.SubElement(joint, "child", link=LINK_NAMES[index])
        upright = (math.pi / 2, 0.0, 0.0) if index == 0 else (0.0, 0.0, 0.0)
        xml.SubElement(joint, "origin", xyz=_text(body.origin), rpy=_text(upright))
        if not parameters.joint[index].fixed:
            _add_doubt(joint, parameters, index, drawn)
            _add_turning(joint, parameters, index)
        parent = LINK_NAMES[index]
    return _document(robot)


def _add_rod(link: xml.Element, body: _Body) -> None:
    """Add a cylinder both to look at and to bump into; a URDF's lies along z."""
    tilt = (-math.pi / 2, 0.0, 0.0) if body.end[1] else (0.0, math.pi / 2, 0.0)
    for use in ("visual", "collision"):
        shape = xml.SubElement(link, use)
        xml.SubElement(shape, "origin", xyz=_text(tuple(part / 2.0 for part in body.end)), rpy=_text(tilt))
        rod = xml.SubElement(xml.SubElement(shape, "geometry"), "cylinder")
        rod.attrib.update(radius=repr(body.radius), length=repr(max(body.end)))


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


def _add_doubt(parent: xml.Element, parameters: ArmParameters, index: int, drawn: Plants) -> None:
    if doubt := doubt_of(parameters, index, drawn):
        parent.append(xml.Comment(f" {doubt} "))


def mjcf(parameters: ArmParameters, drawn: Plants = _SURE, gears: bool = False) -> str:
    """The arm as MJCF: links, stops, friction and motors, whose controls are voltages.

    The link of a joint that is not in use is welded to the one before, without a joint. A comment says what is missing.
    `drawn` as for `urdf`. With `gears`, a joint whose gear has teeth becomes two hinges: the motor's, and one for the
    gear, which turns freely within the gap and on teeth that bend beyond it; the link's angle is their sum.
    """
    model = xml.Element("mujoco", model=parameters.name)
    model.append(xml.Comment(f" Controls are volts. {_RODS} {_left_out(parameters, gears=gears)} "))
    xml.SubElement(model, "compiler", angle="radian")
    gravity = _text((0.0, 0.0, -parameters.gravity))
    lightness = _lightness(parameters) if gears else []
    step = _step(parameters, lightness)
    xml.SubElement(model, "option", gravity=gravity, timestep=repr(step), integrator="RK4")
    default = xml.SubElement(model, "default")
    xml.SubElement(default, "joint", _STIFF)
    xml.SubElement(default, "geom", type="cylinder", contype="0", conaffinity="0", group="1", mass="0")
    parent = xml.SubElement(model, "worldbody")
    tendons, actuators = xml.SubElement(model, "tendon"), xml.SubElement(model, "actuator")
    for index, body in enumerate(_bodies(parameters)):
        frame = {"name": LINK_NAMES[index], "pos": _text(body.origin)}
        if index == 0:
            frame["euler"] = _text((math.pi / 2, 0.0, 0.0))
        parent = xml.SubElement(parent, "body", frame)
        if index in parameters.joints_in_use:
            _add_doubt(parent, parameters, index, drawn)
            _add_motor(parent, actuators, parameters, index)
            if gears and parameters.joint[index].gear.stiffness:
                _add_gear(parent, tendons, parameters, index, lightness[index])
        inertia = _text(body.inertia)
        xml.SubElement(parent, "inertial", pos=_text(body.centre), mass=repr(body.mass), diaginertia=inertia)
        xml.SubElement(parent, "geom", fromto=_text((0.0, 0.0, 0.0, *body.end)), size=repr(body.radius))
    xml.SubElement(parent, "site", name="tip", pos=_text(body.end))
    if not len(tendons):
        model.remove(tendons)
    return _document(model)


def _add_motor(body: xml.Element, actuators: xml.Element, parameters: ArmParameters, index: int) -> None:
    """A hinge and what drives it: a voltage gives torque, less what the back-EMF of the speed takes away."""
    joint, actuator, supply = parameters.joint[index], parameters.actuator(index), parameters.drive.supply
    back_emf = actuator.torque_per_volt * joint.motor.torque_constant * joint.motor.gear_ratio
    xml.SubElement(
        body,
        "joint",
        name=JOINT_IDS[index],
        type="hinge",
        axis=_text(_AXES[index]),
        limited="true",
        range=_text((joint.stops.min, joint.stops.max)),
        armature=repr(actuator.inertia),
        damping=repr(max(actuator.damping - back_emf, 0.0)),
        frictionloss=repr(joint.friction.coulomb),
    )
    xml.SubElement(
        actuators,
        "general",
        name=JOINT_IDS[index],
        joint=JOINT_IDS[index],
        ctrllimited="true",
        ctrlrange=_text((-supply, supply)),
        gainprm=repr(actuator.torque_per_volt),
        biastype="affine",
        biasprm=_text((0.0, 0.0, -back_emf)),
    )


def _add_gear(body: xml.Element, tendons: xml.Element, parameters: ArmParameters, index: int, light: float) -> None:
    """A second hinge behind the motor's, with the grease's drag and the gap as its range; beyond it push the teeth.

    MuJoCo wants their stiffness and damping times `light`, what the hinge's acceleration is for a torque of 1 N m, and
    with an impedance near 0 adds nothing of its own. A tendon holds the link at its stops.
    """
    motor = body.findall("joint")[-1]
    name, gear = JOINT_IDS[index], parameters.joint[index].gear
    stops = {key: motor.attrib.pop(key) for key in ("limited", "range")}
    turns = {
        "name": f"{name}_gear",
        "type": "hinge",
        "axis": _text(_AXES[index]),
        "damping": repr(gear.drag),
        "limited": "true",
        "range": _text((-gear.half_gap, gear.half_gap)),
        "solreflimit": _text((-gear.stiffness * light, -gear.damping * light)),
        "solimplimit": _text((_TEETH_IMPEDANCE, _TEETH_IMPEDANCE, 0.001, 0.5, 2)),
    }
    xml.SubElement(body, "joint", turns)
    link = xml.SubElement(tendons, "fixed", {"name": f"{name}_link", **stops, **_STOPS})
    for one in (name, f"{name}_gear"):
        xml.SubElement(link, "joint", joint=one, coef="1")


def _lightness(parameters: ArmParameters) -> list[float]:
    """The acceleration of each joint's gear for a torque of 1 N m on its teeth, rad/(s^2 N m), the arm at 0."""
    links = np.linalg.inv(Arm(parameters).body.mass_matrix(np.zeros(len(parameters.joint))))
    return [float(links[joint, joint]) + 1.0 / parameters.actuator(joint).inertia for joint in range(len(links))]


def _step(parameters: ArmParameters, lightness: list[float]) -> float:
    """The simulator's step in s: short enough for the stiffest teeth, or for those that damp most."""
    gears = [(parameters.joint[joint].gear, lightness[joint]) for joint in parameters.joints_in_use if lightness]
    rates = [max(math.sqrt(gear.stiffness * light), gear.damping * light) for gear, light in gears]
    # A radian of the fastest motion of teeth at most: from 2.8 on RK4 makes it grow.
    return min([LONGEST_STEP_S, *(1.0 / rate for rate in rates if rate)])


def _left_out(parameters: ArmParameters, *more: str, gears: bool = False) -> str:
    """A phrase for each thing that the arm has and the file cannot hold."""
    joints = [parameters.joint[index] for index in parameters.joints_in_use]
    pots = parameters.follower_pots.joint
    found = {
        "friction at rest above the sliding one": any(one.friction.breakaway > one.friction.coulomb for one in joints),
        "friction that grows with the load": any(one.friction.load for one in joints),
        "creep": any(one.friction.creep_velocity for one in joints),
        "the gears' gaps and teeth": any(one.gear.stiffness for one in joints) and not gears,
        "volts that drivers lose": any(one.driver.lost_up or one.driver.lost_down for one in joints),
        "the supply's resistance": bool(parameters.drive.supply_resistance),
        "potentiometers": any(one.noise or one.play or one.lag or one.linearity for one in pots),
    }
    missing = [*more, *(one for one, has in found.items() if has)]
    return f"Not in this file: {', '.join(missing)}." if missing else "The whole arm is in this file."


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

    ends = [(0.0, link0.length, 0.0), *((link.length, 0.0, 0.0) for link in (link1, link2, link3))]
    radii = [_radius(link0, link0.inertia.yy), *(_radius(link, link.inertia.xx) for link in (link1, link2, link3))]
    return [
        _Body((0.0, 0.0, 0.0), (0.0, link0.centre, 0.0), link0.mass, principal(0), ends[0], radii[0]),
        _Body(ends[0], (link1.centre, 0.0, 0.0), link1.mass, principal(1), ends[1], radii[1]),
        _Body(ends[1], (link2.centre, 0.0, 0.0), link2.mass, principal(2), ends[2], radii[2]),
        _Body(ends[2], (centre3, 0.0, 0.0), mass3, (link3.inertia.xx, across, across), ends[3], radii[3]),
    ]


def _radius(link: Link, about_line: float) -> float:
    """No rod is drawn thicker than long."""
    return min(math.sqrt(2.0 * about_line / link.mass), link.length / 2.0)


def _text(values: tuple[float, ...]) -> str:
    return " ".join(repr(value) for value in values)


def _document(root: xml.Element) -> str:
    xml.indent(root)
    return xml.tostring(root, encoding="unicode") + "\n"
