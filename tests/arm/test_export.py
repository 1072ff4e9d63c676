"""The exported models are whole and carry the arm's own numbers; their physics is compared in tests/oracles."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree as xml

import pytest

from greywhale.arm.export import JOINT_IDS, LINK_NAMES, mjcf, urdf
from greywhale.files.arm import default_arm


def test_urdf_is_a_chain_of_four_limited_joints() -> None:
    parameters = default_arm()
    robot = xml.fromstring(urdf(parameters))
    assert [link.get("name") for link in robot.iter("link")] == ["world", *LINK_NAMES]
    parent = "world"
    for index, joint in enumerate(robot.iter("joint")):
        assert joint.get("name") == JOINT_IDS[index]
        assert joint.find("parent").get("link") == parent  # type: ignore[union-attr]
        parent = str(joint.find("child").get("link"))  # type: ignore[union-attr]
        limit = joint.find("limit")
        assert limit is not None
        assert float(limit.get("upper", "")) == parameters.joint[index].stops.max
        assert float(limit.get("effort", "")) == pytest.approx(15.0 * parameters.actuator(index).torque_per_volt)
    assert parent == LINK_NAMES[-1]


def test_tip_is_merged_into_the_hand(make_arm: Any) -> None:
    robot = xml.fromstring(urdf(make_arm(tip={"mass": 0.1})))
    inertial = list(robot.iter("inertial"))[-1]
    mass, origin = inertial.find("mass"), inertial.find("origin")
    assert mass is not None
    assert origin is not None
    assert float(mass.get("value", "")) == pytest.approx(0.3148)
    assert float(origin.get("xyz", "").split()[0]) == pytest.approx((0.2148 * 0.086 + 0.1 * 0.172) / 0.3148)


def test_mjcf_has_motors_only_when_asked() -> None:
    assert xml.fromstring(mjcf(default_arm())).find("actuator") is None
    motors = xml.fromstring(mjcf(default_arm(), motors=True)).findall("actuator/motor")
    assert [motor.get("joint") for motor in motors] == list(JOINT_IDS)
