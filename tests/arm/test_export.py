"""The exported models are whole and carry the arm's own numbers; their physics is compared in tests/oracles."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree as xml

import pytest

from greywhale.arm.export import JOINT_IDS, mjcf, urdf
from greywhale.files.arm import default_arm


def test_mjcf_carries_what_an_identification_finds(make_arm: Any) -> None:
    arm = make_arm("worn", tip={"mass": 0.1})
    model = xml.fromstring(mjcf(arm))
    assert [rod.get("size") for rod in model.iter("geom")].count(None) == 1, "one default, four rods"
    for index, (hinge, motor) in enumerate(zip(model.iterfind(".//body/joint"), model.iter("general"), strict=True)):
        actuator, joint = arm.actuator(index), arm.joint[index]
        assert motor.get("joint") == hinge.get("name") == JOINT_IDS[index]
        assert numbers(hinge, "range") == [joint.stops.min, joint.stops.max]
        assert numbers(hinge, "armature") == [actuator.inertia]
        assert numbers(hinge, "frictionloss") == [joint.friction.coulomb]
        assert numbers(motor, "gainprm") == [actuator.torque_per_volt]
        assert numbers(motor, "ctrlrange") == [-15.0, 15.0]
        back_emf = -numbers(motor, "biasprm")[2]
        assert numbers(hinge, "damping")[0] + back_emf == pytest.approx(actuator.damping)
        assert back_emf == pytest.approx(
            actuator.torque_per_volt * joint.motor.torque_constant * joint.motor.gear_ratio
        )


def numbers(element: xml.Element, key: str) -> list[float]:
    return [float(part) for part in str(element.get(key)).split()]


@pytest.mark.parametrize("write", [mjcf, urdf])
def test_a_file_names_what_it_leaves_out(make_arm: Any, write: Any) -> None:
    text = write(make_arm("worn"))
    for thing in ("friction at rest", "grows with the load", "creep", "gaps", "the supply's resistance", "potentiom"):
        assert thing in text
    assert "creep" not in write(default_arm())
    assert "The whole arm is in this file" in mjcf(make_arm("white_box"))


def test_only_a_file_that_holds_the_motors_is_called_identified(make_arm: Any) -> None:
    arm = make_arm("white_box").model_copy(update={"name": "my arm, identified"})
    assert xml.fromstring(mjcf(arm)).get("model") == "my arm, identified"
    assert xml.fromstring(urdf(arm)).get("name") == "my arm"
