"""greywhale's closed-form arm against Pinocchio and MuJoCo, which get it only through the exported URDF and MJCF."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from arm_engines import MuJoCo, Pinocchio, arm_with_tip, random_states, without

from greywhale.arm import Arm, ArmParameters
from greywhale.arm.export import mjcf, urdf
from greywhale.arm.from_urdf import import_urdf
from greywhale.arm.plants import plant_row
from greywhale.files.arm import default_arm, load_arm
from tests.arm.reframed import reframed

STATES = 500
TOLERANCE = 1e-9
Engine = Callable[[ArmParameters], Pinocchio | MuJoCo]


@pytest.mark.parametrize("engine", [Pinocchio.of, MuJoCo])
@pytest.mark.parametrize("parameters", [default_arm(), arm_with_tip()], ids=["default", "with tip"])
def test_mass_matrix_and_bias_agree(engine: Engine, parameters: ArmParameters) -> None:
    body = Arm(parameters).body
    other = engine(parameters)
    for q, v in zip(*random_states(STATES, seed=1), strict=True):
        np.testing.assert_allclose(body.mass_matrix(q), other.mass_matrix(q), rtol=0, atol=TOLERANCE)
        np.testing.assert_allclose(body.bias(q, v), other.bias(q, v), rtol=0, atol=TOLERANCE)


@pytest.mark.parametrize("used", [(0,), (2,), (0, 1), (1, 2), (0, 3), (1, 2, 3), (0, 2, 3)])
@pytest.mark.parametrize("engine", [Pinocchio.of, MuJoCo])
def test_joints_that_are_not_in_use_are_welded(engine: Engine, used: tuple[int, ...]) -> None:
    """The engines' own arm of fewer joints has the rows and columns of the whole arm with the others at 0."""
    whole = arm_with_tip()
    body, kept = Arm(whole).body, list(used)
    other = engine(without(whole, used))
    for q, v in zip(*random_states(100, seed=2), strict=True):
        own_q, own_v = np.zeros(4), np.zeros(4)
        own_q[kept], own_v[kept] = q[kept], v[kept]
        mass = body.mass_matrix(own_q)[np.ix_(kept, kept)]
        np.testing.assert_allclose(other.mass_matrix(q[kept]), mass, rtol=0, atol=TOLERANCE)
        np.testing.assert_allclose(other.bias(q[kept], v[kept]), body.bias(own_q, own_v)[kept], rtol=0, atol=TOLERANCE)


def test_averaging_link_3_changes_no_entry_much() -> None:
    parameters = default_arm()
    body = Arm(parameters).body
    exact = Pinocchio.of(parameters)
    inertia = parameters.link[3].inertia
    hand = exact.model.inertias[4]
    hand.inertia = np.diag([inertia.xx, inertia.yy, inertia.zz])
    exact.model.inertias[4] = hand
    changes = [np.abs(body.mass_matrix(q) - exact.mass_matrix(q)).max() for q in random_states(STATES, 1)[0]]
    assert 1e-5 < max(changes) < 3.3e-5


def loaded(parameters: ArmParameters, gears: bool = False) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The exported file as MuJoCo has it, with the step and the integrator that the file says."""
    drawn = plant_row(parameters) * np.array([[0.9], [1.1]])  # the comments disturb nobody
    model = mujoco.MjModel.from_xml_string(mjcf(parameters, drawn, gears))
    return model, mujoco.MjData(model)


def angles(data: mujoco.MjData) -> np.ndarray:
    """The links' angles (4,) rad: a gear turns behind its motor."""
    bodies = data.model.jnt_bodyid
    return np.array([data.qpos[bodies == body].sum() for body in np.unique(bodies)])


def rigid(arm: ArmParameters, friction: bool) -> ArmParameters:
    """A copy of the arm without what MJCF has no words for: no gaps and play, no excess of friction at rest."""
    data = arm.model_dump()
    for joint in data["joint"]:
        sliding = joint["friction"]["coulomb"] if friction else 0.0
        joint |= {"gear": {}, "friction": {"coulomb": sliding, "breakaway": sliding}}
    for pot in data["follower_pots"]["joint"]:
        pot |= {"play": 0.0, "lag": 0.0, "noise": 0.0, "linearity": 0.0}
    data["drive"]["supply_resistance"] = 0.0
    return ArmParameters.model_validate(data, strict=False)


def apart(parameters: ArmParameters, longest_step: float, used: tuple[int, ...] = (0, 1, 2, 3)) -> float:
    """The greatest distance of the two (rad) in 1 s of changing voltages; the file has the joints in use."""
    model, data = loaded(parameters)
    joints = list(used)
    arm = Arm(parameters, longest_step_s=longest_step)
    worst = travel = 0.0
    for block in range(20):
        volts = 4.0 * np.sin(np.array([0.2, 0.25, 0.3, 0.35]) * (block + 1))
        data.ctrl[:] = volts[joints]
        for _ in range(round(0.05 / model.opt.timestep)):
            mujoco.mj_step(model, data)
        worst = max(worst, np.abs(arm.step(volts, 0.05)[joints] - data.qpos).max())
        travel = max(travel, np.abs(data.qpos).min())
    assert travel > 0.1, "every joint must have moved"
    return worst


@pytest.mark.parametrize("name", ["white_box", "grey_box", "default", "worn"])
def test_the_exported_file_moves_as_the_arm_does(name: str) -> None:
    """Rigid gears, no dry friction; ours in steps of 0.2 us, in which its first order is fine enough."""
    arm = rigid(load_arm(name), friction=False)
    assert "The whole arm is in this file." in mjcf(arm)
    assert apart(arm, 2e-7) < 1e-6
    assert apart(arm, 2.5e-4) < 2e-3


@pytest.mark.parametrize("used", [(0, 1), (1,), (0, 2, 3)])
def test_an_arm_with_fewer_joints_moves_as_its_file_does(used: tuple[int, ...]) -> None:
    assert apart(without(load_arm("white_box"), used), 2e-6, used) < 2e-5


@pytest.mark.parametrize("name", ["default", "worn"])
def test_dry_friction_is_nearly_the_same(name: str) -> None:
    """MuJoCo's is soft; docs/arm.md has what it costs, and what the parts cost that the file leaves out."""
    assert apart(rigid(load_arm(name), friction=True), 1e-6) < 3e-4
    assert 1e-3 < apart(load_arm(name), 1e-5) < 0.3


def off_in_steps(parameters: ArmParameters, gears: bool) -> np.ndarray:
    """The greatest distance of each joint (4,) rad from ours in 1 s of steps of voltage: up, off, down, off."""
    model, data = loaded(parameters, gears)
    arm = Arm(parameters, longest_step_s=1e-5)
    worst = np.zeros(4)
    for block in range(40):
        volts = np.array([4.0, 6.0, 4.0, 4.0]) * (1.0, 0.0, -1.0, 0.0)[block // 10]
        data.ctrl[:] = volts
        for _ in range(round(0.025 / model.opt.timestep)):
            mujoco.mj_step(model, data)
        worst = np.maximum(worst, np.abs(arm.step(volts, 0.025) - angles(data)))
    return worst


@pytest.mark.parametrize("name", ["default", "worn"])
def test_gears_with_a_gap_and_teeth_answer_a_step_as_ours_do(name: str) -> None:
    """The base, which nothing pulls to one side, may lie anywhere in its gap of 4 mrad to either side."""
    arm = load_arm(name)
    friction = rigid(arm, friction=True)
    kept = tuple(one.model_copy(update={"gear": arm.joint[n].gear}) for n, one in enumerate(friction.joint))
    worn = friction.model_copy(update={"joint": kept})
    assert "The whole arm is in this file." in mjcf(worn, gears=True)
    with_gears, without_gears = off_in_steps(worn, True), off_in_steps(worn, False)
    assert (with_gears < [4.5e-3, 2.5e-3, 1.5e-3, 1e-3]).all(), with_gears
    assert (without_gears > 6e-3).all(), "so they do matter"


def test_teeth_that_are_much_stiffer_get_a_shorter_step() -> None:
    """At the usual step MuJoCo would shake them apart."""
    arm = rigid(load_arm("default"), friction=True)
    data = arm.model_dump()
    data["joint"][2]["gear"] = {"half_gap": 0.001, "stiffness": 5e3, "damping": 40.0, "drag": 0.05}
    assert (off_in_steps(ArmParameters.model_validate(data, strict=False), gears=True) < 2e-3).all()


@pytest.mark.parametrize("gears", [False, True])
def test_the_exported_stops_hold(gears: bool) -> None:
    parameters = load_arm("default")
    model, data = loaded(parameters, gears)
    data.ctrl[:] = parameters.drive.supply
    for _ in range(4000):
        mujoco.mj_step(model, data)
        assert (angles(data) < 2.55 + 5e-3).all()
    assert angles(data) == pytest.approx([2.55] * 4, abs=1e-3)
    data.ctrl[:] = 1e3
    mujoco.mj_step(model, data)
    gains = [parameters.actuator(joint).torque_per_volt for joint in range(4)]
    assert data.actuator_force == pytest.approx(parameters.drive.supply * np.array(gains), rel=1e-2)


@pytest.mark.parametrize("used", [(0, 1, 2, 3), (0, 1)])
def test_two_readers_of_urdf_see_the_same_links_and_rods(used: tuple[int, ...]) -> None:
    text = urdf(without(arm_with_tip(), used))
    theirs = mujoco.MjModel.from_xml_string(text)  # its own compiler, which drops what is there for the eye alone
    model = pinocchio.buildModelFromXML(text)
    shapes = {
        kind: pinocchio.buildGeomFromUrdfString(model, text, kind).geometryObjects
        for kind in (pinocchio.GeometryType.VISUAL, pinocchio.GeometryType.COLLISION)
    }
    ours = mujoco.MjModel.from_xml_string(mjcf(without(arm_with_tip(), used)))
    assert theirs.nv == model.nv == len(used)
    np.testing.assert_allclose(theirs.jnt_range, ours.jnt_range)
    for objects in shapes.values():
        sizes = [(one.geometry.radius, one.geometry.halfLength) for one in objects]
        np.testing.assert_allclose(sizes, ours.geom_size[:, :2], atol=1e-12)
    centres = geom_centres(ours)
    np.testing.assert_allclose(geom_centres(theirs), centres, atol=1e-9)
    assert not np.allclose(centres[:, 2], centres[0, 2])


def geom_centres(model: mujoco.MjModel) -> np.ndarray:
    """The centres of the rods in a bent pose, (4, 3)."""
    data = mujoco.MjData(model)
    data.qpos[:] = 0.4
    mujoco.mj_forward(model, data)
    return np.array(data.geom_xpos)


@pytest.mark.parametrize("seed", range(6))
def test_an_imported_urdf_moves_as_pinocchio_says(tmp_path: Path, seed: int) -> None:
    """Frames, signs and zero pose at random: Pinocchio reads the URDF itself, greywhale what it has made of it."""
    random = np.random.default_rng(seed)
    flips = tuple(joint for joint in range(4) if random.random() < 0.5)
    zero = (0.0, float(random.uniform(-1.2, 1.2)), float(random.uniform(-1.2, 1.2)), 0.0)
    path = tmp_path / "arm.urdf"
    path.write_text(reframed(arm_with_tip(), seed, flips, zero))
    found = import_urdf(path, 15.0)
    body = Arm(found.arm).body
    other = Pinocchio(path.read_text())
    signs = np.diag(found.signs)
    for q, v in zip(*random_states(100, seed), strict=True):
        own = found.signs * q + found.offsets
        mass, bias = signs @ body.mass_matrix(own) @ signs, signs @ body.bias(own, signs @ v)
        np.testing.assert_allclose(mass, other.mass_matrix(q), rtol=0, atol=TOLERANCE)
        np.testing.assert_allclose(bias, other.bias(q, v), rtol=0, atol=TOLERANCE)
