"""How far a voltage moves each joint, from a model: the margin, the ends, and when the board's own numbers stay."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.arm.body import Body
from greywhale.arm.plants import plant_row
from greywhale.files.arm import load_arm
from greywhale.protocol.table import ParameterTable
from greywhale.tune.limits import TUNING_LIMITS
from greywhale.tune.model import load_model
from greywhale.tune.travel import Travel, travel_of
from tests.support.arms import make_arm
from tests.tune.models import write_model


def with_tip(mass: float) -> ArmParameters:
    """The default arm with a load, kg."""
    return make_arm(tip={"mass": mass})


def travel(folder: Path, arm: ArmParameters, deviation: float = 0.03, **changes: int) -> Travel:
    identified = load_arm(write_model(folder / "model.toml", arm, deviation=deviation))
    found = travel_of(identified, ParameterTable.defaults().with_raw(changes))
    assert found is not None
    return found


def test_a_joint_must_move_with_a_margin_on_its_friction(tmp_path: Path) -> None:
    arm = with_tip(0.5)
    found = travel(tmp_path, arm, deviation=0.001)
    for joint, volts in enumerate(found.breakaway_v):
        friction = arm.joint[joint].friction.breakaway / arm.actuator(joint).torque_per_volt
        assert volts >= max((1 + TUNING_LIMITS.travel.least_margin) * friction, TUNING_LIMITS.travel.least_v) * 0.999
    assert found.note == ""


def test_an_uncertain_model_gets_a_wider_margin(tmp_path: Path) -> None:
    sure, unsure = (travel(tmp_path, with_tip(0.5), deviation) for deviation in (0.001, 0.15))
    assert sure.gravity_v == pytest.approx(unsure.gravity_v)
    assert np.all(np.array(unsure.breakaway_v) >= sure.breakaway_v)
    assert unsure.breakaway_v[1] > sure.breakaway_v[1]


def test_the_gravity_terms_hold_the_arm_in_any_pose(tmp_path: Path) -> None:
    arm = with_tip(0.6)
    one, both, two = travel(tmp_path, arm).gravity_v
    for shoulder, wrist in ((0.0, 0.0), (-0.7, 0.4), (1.1, -1.5), (0.5, 1.2)):
        pose = np.array([[0.0, shoulder, wrist, 0.0]])
        torque = Body.of(plant_row(arm)).bias(pose, np.zeros_like(pose))[0]
        first, second = (torque[joint] / arm.actuator(joint).torque_per_volt for joint in (1, 2))
        assert first == pytest.approx(one * np.cos(shoulder) + both * np.cos(shoulder + wrist), abs=0.02)
        assert second == pytest.approx(two * np.cos(shoulder + wrist), abs=0.02)


def test_what_the_supply_cannot_give_is_told(tmp_path: Path) -> None:
    found = travel(tmp_path, with_tip(6.0), supply_mv=3000)
    assert max(found.breakaway_v) == pytest.approx(TUNING_LIMITS.travel.max_supply_share * 3.0)
    assert "its breakaway_volts can be 2.4 V at most" in found.note


def test_a_check_that_is_off_stays_off(tmp_path: Path) -> None:
    identified = load_arm(write_model(tmp_path / "model.toml", with_tip(0.5)))
    assert travel_of(identified, ParameterTable.defaults().with_raw({"stall_volts": 0})) is None


def test_without_a_covariance_the_boards_own_stays(tmp_path: Path) -> None:
    assert load_model(write_model(tmp_path / "model.toml", covariance=None), force=True).travel is None
    assert load_model(write_model(tmp_path / "model.toml")).travel is not None
