"""A joint that is not in use is exactly rigid, and the rest move as the four-joint arm with its row and column gone."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from greywhale import _native
from greywhale.arm import Arm
from greywhale.arm.export import JOINT_IDS, LINK_NAMES, mjcf, urdf
from greywhale.arm.plants import plant_row, rigid_joints
from greywhale.base.errors import UserError
from greywhale.files.arm import load_arm
from greywhale.files.model import arm_toml
from greywhale.loop import Experiment, human_reaches
from greywhale.protocol.joints import unused
from greywhale.tune.judge.floor import saturation_floor
from tests.support.arms import with_joints

SETS = [(0,), (3,), (1, 2), (0, 2, 3)]


@pytest.mark.parametrize("used", SETS)
def test_it_stays_exactly_where_it_is_whatever_the_others_do(used: tuple[int, ...]) -> None:
    arm = Arm(with_joints(used))
    random = np.random.default_rng(1)
    travel = np.zeros(4)
    for _ in range(400):
        arm.step(random.choice([-15.0, 15.0], 4), 0.01)
        for values in (arm.angles, arm.velocities, arm.motor_angles, arm.motor_velocities):
            assert (values[list(unused(used))] == 0.0).all()
        travel = np.maximum(travel, np.abs(arm.angles))
    assert (travel[list(used)] > 0.1).all()
    assert arm.unsettled_steps == 0


@pytest.mark.parametrize("used", SETS)
def test_the_rest_moves_as_the_arm_with_its_row_and_column_removed(used: tuple[int, ...]) -> None:
    """Rigid gears and no dry friction: an ordinary differential equation for the joints in use alone."""
    whole = load_arm("white_box")
    body, kept = Arm(whole).body, list(used)
    motors = [whole.actuator(joint) for joint in used]
    torque, rotor, damping = np.array([[one.torque_per_volt, one.inertia, one.damping] for one in motors]).T
    volts = np.array([2.0, 1.5, -1.0, 1.0])

    def motion(_: float, y: np.ndarray[Any, np.dtype[np.float64]]) -> np.ndarray[Any, np.dtype[np.float64]]:
        q, v = np.zeros(4), np.zeros(4)
        q[kept], v[kept] = y[: len(kept)], y[len(kept) :]
        mass = body.mass_matrix(q)[np.ix_(kept, kept)] + np.diag(rotor)
        a = np.linalg.solve(mass, torque * volts[kept] - damping * v[kept] - body.bias(q, v)[kept])
        return np.concatenate([v[kept], a])

    exact = solve_ivp(motion, (0, 0.5), np.zeros(2 * len(kept)), rtol=1e-10, atol=1e-12).y[: len(kept), -1]
    arm = Arm(with_joints(used, "white_box"), longest_step_s=2e-6)
    found = arm.step(volts, 0.5)
    assert np.abs(exact).min() > 0.02
    np.testing.assert_allclose(found[kept], exact, rtol=0, atol=2e-5)


@pytest.mark.parametrize("worn", [False, True])
def test_batch_single_run_and_ideal_law_hold_it(worn: bool) -> None:
    arm = with_joints((0, 1), "worn" if worn else "default")
    assert rigid_joints(plant_row(arm)).tolist() == [False, False, True, True]
    experiment = Experiment(human_reaches(4, 3.0), arm, noise=False)
    batch, exact = experiment.run(every=1, steps_per_tick=4), experiment.run_exact(every=1)
    for result in (batch, exact):
        np.testing.assert_array_equal(result.angles[..., 2:], 0.0)
        np.testing.assert_array_equal(result.mse[:, 2:], 0.0)
        assert not result.diverged.any()
    np.testing.assert_allclose(batch.angles, exact.angles, atol=5e-3)
    assert np.abs(exact.angles[..., :2]).max() > 0.2
    slices = np.repeat(experiment.leader, 4, axis=0)
    floor = saturation_floor(slices, plant_row(arm))
    np.testing.assert_array_equal(floor.mse[2:], 0.0)
    assert (floor.mse[:2] > 0.0).all()


def test_windows_hold_it_bit_by_bit() -> None:
    arm, rows, substeps, h = with_joints((1, 3)), 50, 4, 0.25e-3
    volts = np.random.default_rng(5).uniform(-15, 15, (rows * substeps, 4))
    window: dict[str, Any] = {"first": np.zeros(1, dtype=np.int64), "angles": np.array([[0.0, 0.2, 0.0, 0.4]])}
    window |= {name: np.zeros((1, 4)) for name in ("offsets", "velocities", "sides", "places")}
    window |= {"rows": rows, "spacing": np.full(rows, h * substeps), "substeps": substeps, "every": 1}
    angles = np.asarray(_native.simulate_windows(plants=plant_row(arm)[None], volts=volts, **window))[0, 0]
    np.testing.assert_array_equal(angles[:, [0, 2]], 0.0)
    assert np.ptp(angles[:, [1, 3]], axis=0).min() > 0.001


def test_an_arm_file_needs_no_more_than_the_word(tmp_path: Path) -> None:
    arm = with_joints((0, 1))
    path = tmp_path / "arm.toml"
    text = arm_toml(arm, "two joints")
    path.write_text(text)
    assert load_arm(path).joints_in_use == (0, 1)
    assert text.count("motor =") == 2
    assert text.count("fixed = true") == 2
    assert "fixed = false" not in text
    np.testing.assert_array_equal(plant_row(load_arm(path)), plant_row(arm))


def test_an_arm_needs_a_joint_that_moves(make_arm: Any) -> None:
    with pytest.raises(UserError, match="all four joints are fixed"):
        make_arm(every_joint={"fixed": True})


def test_exports_weld_it() -> None:
    arm = with_joints((0, 2))
    kinds = [joint.get("type") for joint in xml.fromstring(urdf(arm)).iter("joint")]
    assert kinds == ["revolute", "fixed", "revolute", "fixed"]
    model = xml.fromstring(mjcf(arm))
    assert [body.get("name") for body in model.iter("body")] == list(LINK_NAMES)
    assert [joint.get("name") for joint in model.iterfind(".//body/joint")] == [JOINT_IDS[0], JOINT_IDS[2]]
    assert [motor.get("joint") for motor in model.iter("general")] == [JOINT_IDS[0], JOINT_IDS[2]]
