"""arm.toml: what ships, and one clear sentence for everything that is wrong."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import Any

import pytest

from greywhale.arm import Arm
from greywhale.arm.plants import check_plants, column, plant_row
from greywhale.base.errors import UserError
from greywhale.files.arm import arm_names, default_arm, load_arm
from greywhale.files.controller import load
from greywhale.files.paper_tables import paper_table
from greywhale.tune.report.tables import PAPER_STEADY_STATE
from tests.support.sentences import names

DEFAULT = resources.files("greywhale.arm").joinpath("data", "default.toml").read_text(encoding="utf-8")


def test_shipped_arms_load_and_move() -> None:
    assert arm_names() == ["default", "grey_box", "sticky_grey_box", "two_joints", "white_box", "worn"]
    for name in arm_names():
        arm = Arm(load_arm(name))
        moved = abs(arm.step([10.0] * 4, 0.5))
        assert moved[list(arm.parameters.joints_in_use)].min() > 0.05


def test_paper_arms_hold_the_papers_values() -> None:
    white, grey = load_arm("white_box"), load_arm("grey_box")
    assert [joint.motor.resistance for joint in white.joint] == [3.6, 0.8, 2.4, 6.3]
    assert [joint.motor.gear_ratio for joint in white.joint] == [0.8] * 4
    assert [joint.motor.inertia for joint in grey.joint] == [18.302, 4.477, 0.918, 0.176]
    assert [joint.motor.viscous for joint in grey.joint] == [0.495, 5.731, 20.405, 0.457]
    for arm in (white, grey, default_arm()):
        assert [link.mass for link in arm.link] == [0.21, 0.13, 0.11, 0.2148]
        assert [link.length for link in arm.link] == [0.086, 0.14, 0.049, 0.172]
        assert arm.link[0].inertia.yy == 8.26e-5


def test_friction_holds_the_sticky_arm_where_table_11_says_that_it_rests() -> None:
    grey, sticky = load_arm("grey_box"), load_arm("sticky_grey_box")
    laws = load(paper_table("before_tuning")).joint
    for number, (joint, left) in enumerate(zip(sticky.joint, PAPER_STEADY_STATE[0], strict=True)):
        assert joint.motor == grey.joint[number].motor
        law = laws[number]
        volts = law.ku * min(1.0, law.kp * left / law.sets.Pe_b)
        assert joint.friction.coulomb / sticky.actuator(number).torque_per_volt == pytest.approx(volts, abs=0.05)


def test_default_motors_are_near_the_white_box_but_not_equal() -> None:
    """Each of the three combinations that motion reveals lies within e^0.4 of the white box, and none is the same."""
    white, default = load_arm("white_box"), default_arm()
    for joint in range(4):
        # Both by the same equation, so that the motors are compared and not the equations.
        near = white.model_copy(update={"motor_equation": "physical"}).actuator(joint)
        ours = default.actuator(joint)
        for one, other in (
            (1 / ours.torque_per_volt, 1 / near.torque_per_volt),
            (ours.inertia / ours.torque_per_volt, near.inertia / near.torque_per_volt),
            (ours.damping / ours.torque_per_volt, near.damping / near.torque_per_volt),
        ):
            assert one != pytest.approx(other, rel=0.005)
            assert 0.67 < one / other < 1.5


@pytest.mark.parametrize(
    ("old", "new", "things"),
    [
        ("mass = 0.21\n", "mass = -0.21\n", "link[0].mass -0.21 1e-09"),
        ("yy = 8.26e-5", "yy = 8.26e-3", "link[0].inertia yy 0.00826 xx + zz 0.000258"),
        ("centre = 0.07\n", "centre = 0.2\n", "link[1] centre 0.2 length 0.14"),
        ("min = -2.55, max = 2.55", "min = 2.55, max = -2.55", "joint[0].stops min 2.55 max"),
        ("coulomb = 0.078", "coulomb = 0.2", "joint[0].friction breakaway 0.1 coulomb 0.2"),
        ("stiffness = 320.0", "stiffness = 0.0", "joint[0].gear half_gap 0.004 stiffness 0"),
        ("gear_ratio = 0.8", "gear_ratio = 1e-30", "joint[0].motor.gear_ratio 1e-30 0.001"),
        ("gravity = 9.81", "gravity = 981", "gravity 981 0 100"),
        ("gravity = 9.81", "gravity = nan", "gravity nan finite"),
        ("supply = 15.0", "supply = 150.0", "drive.supply 150.0 0 60"),
        ("direction = 1,", "direction = 2,", "leader_pots.joint[0].direction 2 1 -1"),
        ('motor_equation = "physical"', 'motor_equation = "printed"', 'motor_equation "printed"'),
        ("[drive]\nsupply = 15.0", "[drives]\nsupply = 15.0", "unknown drives"),
    ],
)
def test_bad_values_are_refused_by_file_key_value_and_reason(tmp_path: Path, old: str, new: str, things: str) -> None:
    assert old in DEFAULT
    path = tmp_path / "arm.toml"
    path.write_text(DEFAULT.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(UserError) as refused:
        load_arm(path)
    assert names(refused.value.message, f"{path}: {things}")


def test_drivers_lose_twice_the_supply_at_most(make_arm: Any) -> None:
    """Beyond it no voltage can arrive, and the bounds of what the ideal controller asks for would cross."""
    drive = {"supply": 6.0}
    arm = make_arm("default", drive=drive, every_joint={"driver": {"lost_up": 7.0, "lost_down": 5.0}})
    check_plants(plant_row(arm))
    with pytest.raises(UserError, match=r"joint\[0\].driver .* 12.1 V, more than twice the supply of 6 V"):
        make_arm("default", drive=drive, every_joint={"driver": {"lost_up": 7.1, "lost_down": 5.0}})
    edited = plant_row(arm)
    edited[column("lost_down", 2)] = 5.2
    with pytest.raises(UserError, match=r"joint2.lost_up is 7, but with lost_down"):
        check_plants(edited)


def test_missing_joint_is_refused(tmp_path: Path) -> None:
    start, end = DEFAULT.index("[[joint]]             # 3"), DEFAULT.index("[drive]")
    path = tmp_path / "arm.toml"
    path.write_text(DEFAULT[:start] + DEFAULT[end:], encoding="utf-8")
    with pytest.raises(UserError, match="joint: it lists 3, .* four"):
        load_arm(path)
