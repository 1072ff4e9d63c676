"""The exported models are whole and carry the arm's own numbers; their physics is compared in tests/oracles."""

from __future__ import annotations

import re
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np
import pytest

from greywhale.arm.export import JOINT_IDS, mjcf, urdf
from greywhale.arm.plants import column, plant_row
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


def test_each_joint_says_what_the_logs_allow_of_it(make_arm: Any) -> None:
    """95 % of the drawn plants, beside the number itself; a number that nobody doubts is not named."""
    arm = make_arm("worn")
    drawn = np.tile(plant_row(arm), (201, 1))
    inertia, gap = arm.actuator(1).inertia, arm.joint[1].gear.half_gap
    drawn[:, column("inertia", 1)] *= np.linspace(0.8, 1.2, 201)
    drawn[:, column("half_gap", 1)] *= np.linspace(0.0, 2.0, 201)
    for text in (mjcf(arm, drawn), mjcf(arm, drawn, gears=True), urdf(arm, drawn)):
        comments = [one for one in re.findall("<!-- (.*) -->", text) if "logs allow" in one]
        assert comments == [
            "95 % of the arms that the logs allow: "
            f"armature {inertia:.4g} [{0.81 * inertia:.4g}, {1.19 * inertia:.4g}] kg m2, "
            f"half of the gear's gap {gap:.4g} [{0.05 * gap:.4g}, {1.95 * gap:.4g}] rad."
        ]
        assert text.index(JOINT_IDS[0]) < text.index(comments[0]) < text.index(JOINT_IDS[2])
    assert "logs allow" not in mjcf(arm) + urdf(arm)


def test_a_gear_is_a_second_hinge_with_the_gap_as_its_range(make_arm: Any) -> None:
    arm = make_arm("worn", joint_3={"gear": {"half_gap": 0.0, "stiffness": 0.0}})
    model = xml.fromstring(mjcf(arm, gears=True))
    hinges = {one.get("name"): one for one in model.iterfind(".//body/joint")}
    assert set(hinges) == {*JOINT_IDS, *(f"{name}_gear" for name in JOINT_IDS[:3])}
    for index, name in enumerate(JOINT_IDS[:3]):
        gear = arm.joint[index].gear
        assert numbers(hinges[f"{name}_gear"], "range") == [-gear.half_gap, gear.half_gap]
        assert numbers(hinges[f"{name}_gear"], "damping") == [gear.drag]
        assert hinges[name].get("range") is None, "the stops are the link's"
    links = {one.get("name"): numbers(one, "range") for one in model.iterfind("tendon/fixed")}
    assert links == {
        f"{name}_link": [arm.joint[n].stops.min, arm.joint[n].stops.max] for n, name in enumerate(JOINT_IDS[:3])
    }
    assert "gaps" not in mjcf(arm, gears=True)
