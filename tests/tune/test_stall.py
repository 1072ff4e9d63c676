"""The board's stall_volts from a model: its margin, its ends, and when it is left alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.files.arm import default_arm, load_arm
from greywhale.protocol.table import ParameterTable
from greywhale.tune.model import load_model
from greywhale.tune.stall import LEAST_MARGIN, LEAST_V, MOST_OF_SUPPLY, StallLimit, stall_limit
from tests.tune.models import write_model


def with_tip(mass: float) -> ArmParameters:
    """The default arm with a load, kg."""
    arm = default_arm()
    return arm.model_copy(update={"tip": arm.tip.model_copy(update={"mass": mass})})


def limit_of(folder: Path, arm: ArmParameters, deviation: float = 0.03, **changes: int) -> StallLimit | None:
    identified = load_arm(write_model(folder / "model.toml", arm, deviation=deviation))
    return stall_limit(identified, ParameterTable.defaults().with_raw(changes))


def test_it_lies_a_margin_above_the_joint_that_needs_most(tmp_path: Path) -> None:
    limit = limit_of(tmp_path, with_tip(0.5))
    assert limit is not None
    assert limit.joint == 2
    assert limit.volts == pytest.approx((1 + LEAST_MARGIN) * max(limit.needs), abs=0.1)
    assert limit.volts >= (1 + LEAST_MARGIN) * max(limit.needs)
    assert "joint 2 (wrist pitch) needs" in limit.sentence
    assert limit.note == ""


def test_an_uncertain_model_gets_a_wider_margin(tmp_path: Path) -> None:
    sure, unsure = (limit_of(tmp_path, with_tip(0.5), deviation) for deviation in (0.001, 0.15))
    assert sure is not None
    assert unsure is not None
    np.testing.assert_allclose(sure.needs, unsure.needs)
    assert unsure.volts >= max(np.array(unsure.needs) + 3.0 * np.array(unsure.deviations)) > sure.volts


def test_a_heavier_arm_gets_a_higher_limit_and_a_light_one_the_least(tmp_path: Path) -> None:
    white = load_arm("white_box")
    light = white.model_copy(update={"gravity": 1.0})
    limits = [limit_of(tmp_path, arm) for arm in (light, with_tip(0.0), with_tip(0.6))]
    volts = [limit.volts for limit in limits if limit is not None]
    assert volts[0] == LEAST_V < volts[1] < volts[2]


def test_what_the_supply_cannot_give_is_told(tmp_path: Path) -> None:
    limit = limit_of(tmp_path, with_tip(3.0), supply_mv=12000)
    assert limit is not None
    assert limit.volts == pytest.approx(MOST_OF_SUPPLY * 12.0)
    assert "stall_volts can be 9.6 V at most" in limit.note


def test_a_check_that_is_off_stays_off(tmp_path: Path) -> None:
    assert limit_of(tmp_path, with_tip(0.5), stall_volts=0) is None


def test_without_a_covariance_the_boards_own_stays(tmp_path: Path) -> None:
    assert load_model(write_model(tmp_path / "model.toml", covariance=None), force=True).stall is None
    assert load_model(write_model(tmp_path / "model.toml")).stall is not None
