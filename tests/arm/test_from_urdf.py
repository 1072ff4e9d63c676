"""Arms from URDFs: whatever frames, signs and zero pose, the same physics; what does not fit is refused by name."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree as xml

import numpy as np
import pytest

from greywhale.arm import Arm, ArmParameters
from greywhale.arm.export import urdf
from greywhale.arm.from_urdf import import_urdf
from greywhale.base.errors import UserError
from greywhale.cli.entry import run
from greywhale.files.arm import default_arm, load_arm
from tests.arm.reframed import reframed
from tests.support.arms import with_joints

SUPPLY = default_arm().drive.supply


def written(folder: Path, text: str) -> Path:
    path = folder / "arm.urdf"
    path.write_text(text)
    return path


@pytest.mark.parametrize("name", ["white_box", "worn"])
def test_an_exported_arm_comes_back(tmp_path: Path, name: str) -> None:
    arm = load_arm(name)
    found = import_urdf(written(tmp_path, urdf(arm)), arm.drive.supply)
    assert found.signs.tolist() == [1, 1, 1, 1]
    assert found.offsets == pytest.approx(np.zeros(4), abs=1e-9)
    same_physics(found.arm, arm)
    for joint in range(4):
        one, other = arm.actuator(joint), found.arm.actuator(joint)
        assert other.torque_per_volt == pytest.approx(one.torque_per_volt)
        assert other.damping == pytest.approx(one.damping)
        assert found.arm.joint[joint].stops.max == pytest.approx(arm.joint[joint].stops.max)
        assert found.arm.joint[joint].friction.coulomb == pytest.approx(arm.joint[joint].friction.coulomb)


def states() -> zip[tuple[np.ndarray, np.ndarray]]:
    random = np.random.default_rng(0)
    return zip(random.uniform(-2, 2, (40, 4)), random.uniform(-3, 3, (40, 4)), strict=True)


def same_physics(found: ArmParameters, arm: ArmParameters) -> None:
    bodies = Arm(found).body, Arm(arm).body
    for q, v in states():
        assert bodies[0].mass_matrix(q) == pytest.approx(bodies[1].mass_matrix(q), abs=1e-9)
        assert bodies[0].bias(q, v) == pytest.approx(bodies[1].bias(q, v), abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_frames_signs_and_zero_pose_do_not_matter(tmp_path: Path, seed: int) -> None:
    random = np.random.default_rng(seed)
    flips = tuple(joint for joint in range(4) if random.random() < 0.5)
    zero = (0.0, float(random.uniform(-1.2, 1.2)), float(random.uniform(-1.2, 1.2)), 0.0)
    arm = default_arm()
    found = import_urdf(written(tmp_path, reframed(arm, seed, flips, zero)), SUPPLY)
    assert found.signs.tolist() == [-1.0 if joint in flips else 1.0 for joint in range(4)]
    assert found.offsets == pytest.approx(zero, abs=1e-9)
    same_physics(found.arm, arm)
    for joint in range(4):
        stops = found.arm.joint[joint].stops
        assert (stops.min, stops.max) == pytest.approx((arm.joint[joint].stops.min, arm.joint[joint].stops.max))


def test_links_that_are_welded_count_as_one(tmp_path: Path) -> None:
    arm = default_arm()
    text = urdf(arm)
    hand = text.index('<link name="hand">')
    mass = text.index("<mass value=", hand)
    end = text.index("/>", mass)
    whole = float(text[mass:end].split('"')[1])
    half = text[:mass] + f'<mass value="{whole / 2!r}" ' + text[end:]
    inertial = text[text.index("<origin", hand) : mass]
    tool = (
        f'<link name="tool"><inertial>{inertial}<mass value="{whole / 2!r}"/>'
        '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>'
        '<joint name="mount" type="fixed"><parent link="hand"/><child link="tool"/></joint>'
    )
    found = import_urdf(written(tmp_path, half.replace("</robot>", tool + "</robot>")), SUPPLY)
    same_physics(found.arm, arm)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('type="revolute"', 'type="prismatic"', "joint base_yaw is prismatic"),
        ('<axis xyz="1 0 0"', '<axis xyz="0 1 0"', "joint wrist_roll, the wrist roll, has its axis"),
        ('<axis xyz="0 1 0"', '<axis xyz="1 0 0"', "joint base_yaw, the base yaw"),
        ('<child link="hand"', '<child link="base"', "link base has two parents"),
        ('<parent link="wrist"', '<parent link="base"', "the chain branches"),
        ("<mass value=", "<mass kg=", "value of base is missing"),
        ("<robot", "<!DOCTYPE x><robot", "declares entities"),
        ("</robot>", "", "this is no XML"),
        ('mass value="0.2148"', 'mass value="0"', "link hand has no mass; every moving link needs some"),
        ('mass value="0.13"', 'mass value="-0.13"', "the mass of link upper_arm is -0.13 kg"),
        ('mass value="0.13"', 'mass value="1e-12"', "link[1].mass is 1e-12"),
        ('ixx="3.17e-05" ixy="0" ixz="0" iyy="0.000398" iyz="0" izz="0.000398"', "", "upper_arm has no inertia"),
        ('xyz="0.07 0.0 0.0"', 'xyz="0.07 0.0 1e300"', "but it must be three numbers of at most 1e+06"),
        ("effort=", "strength=", "joint base_yaw has no effort"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(tmp_path: Path, old: str, new: str, says: str) -> None:
    text = urdf(default_arm())
    assert old in text
    with pytest.raises(UserError, match=re.escape(says)):
        import_urdf(written(tmp_path, text.replace(old, new, 1)), SUPPLY)


def test_thousands_of_fixed_joints_are_welded(tmp_path: Path) -> None:
    """More than Python's own stack would take, and each of them moves what follows."""
    names = ["hand", *(f"spacer{number}" for number in range(1500))]
    spacers = "".join(
        f'<link name="{name}"/><joint name="to_{name}" type="fixed"><parent link="{before}"/><child link="{name}"/>'
        '<origin xyz="0.00001 0 0"/></joint>'
        for before, name in pairwise(names)
    )
    mass = '<inertial><mass value="0.5"/><inertia/></inertial>'
    heavy = spacers.replace('<link name="spacer1499"/>', f'<link name="spacer1499">{mass}</link>')
    found = import_urdf(written(tmp_path, urdf(default_arm()).replace("</robot>", heavy + "</robot>")), SUPPLY)
    hand = found.arm.link[3]
    assert hand.mass == pytest.approx(0.2148 + 0.5)
    assert hand.centre == pytest.approx((0.2148 * 0.086 + 0.5 * 0.015) / 0.7148)


def test_the_verb_writes_an_arm_that_other_verbs_read_and_no_file_twice(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = written(tmp_path, reframed(default_arm(), 3, (1,), (0.0, 0.4, -0.2, 0.0)))
    out = tmp_path / "mine.toml"
    assert run(["arm", "import", str(source), "--out", str(out)]) == 0
    same_physics(load_arm(out), default_arm())
    assert "shoulder pitch  -q +22.9" in capsys.readouterr().out
    assert run(["arm", "import", str(source), "--out", str(out)]) == 2


@pytest.mark.parametrize(("count", "seed"), [(1, None), (1, 1), (2, 2), (3, None)])
def test_a_chain_that_ends_earlier_is_an_arm_with_fewer_joints(tmp_path: Path, count: int, seed: int | None) -> None:
    """The exported arm's welds are not in the URDF's chain any more; what moves is the same."""
    arm = with_joints(tuple(range(count)))
    text = urdf(arm) if seed is None else welded(reframed(default_arm(), seed), count)
    found = import_urdf(written(tmp_path, text), SUPPLY)
    assert found.arm.joints_in_use == tuple(range(count))
    assert found.offsets == pytest.approx(np.zeros(4), abs=0.35)
    bodies = Arm(found.arm).body, Arm(arm).body
    for q, v in states():
        q[count:] = v[count:] = 0.0
        own = found.signs * q + found.offsets
        own[count:] = 0.0
        one, other = bodies[0].mass_matrix(own), bodies[1].mass_matrix(q)
        assert one[:count, :count] == pytest.approx(other[:count, :count], abs=1e-6)
        assert bodies[0].bias(own, v)[:count] == pytest.approx(bodies[1].bias(q, v)[:count], abs=1e-5)
    for joint in range(count):
        assert found.arm.joint[joint].stops.max == pytest.approx(arm.joint[joint].stops.max, abs=0.35)


def test_a_shorter_chain_must_be_one_of_this_arm_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = welded(urdf(default_arm()), 2)
    with pytest.raises(UserError, match="joint base_yaw, the base yaw, does not turn about the vertical"):
        import_urdf(written(tmp_path, text.replace('<axis xyz="0 1 0"', '<axis xyz="1 0 0"')), SUPPLY)
    with pytest.raises(UserError, match="it has 0 turning joints"):
        import_urdf(written(tmp_path, welded(text, 0)), SUPPLY)
    assert run(["arm", "import", str(written(tmp_path, text)), "--out", str(tmp_path / "two.toml")]) == 0
    assert "wrist roll       not in use" in capsys.readouterr().out
    assert load_arm(tmp_path / "two.toml").joints_in_use == (0, 1)


def welded(text: str, count: int) -> str:
    """The URDF with all joints but the first `count` fixed."""
    robot = xml.fromstring(text)
    for joint in robot.findall("joint")[count:]:
        joint.set("type", "fixed")
    return xml.tostring(robot, encoding="unicode")
