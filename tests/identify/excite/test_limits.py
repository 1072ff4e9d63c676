"""Ranges, strengths and the arms that a motion is tried on; what is refused and how that is said."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.arm.plants import columns
from greywhale.base.errors import BAD_USAGE, UserError
from greywhale.files.arm import load_arm
from greywhale.identify.excite.limits import family, limits_of, parse_range
from greywhale.identify.limits import IDENTIFICATION_LIMITS
from greywhale.loop import plant_row
from greywhale.protocol.table import ParameterTable

WANTED = IDENTIFICATION_LIMITS.excitation

POSE = np.array([0.0, 0.45, -0.1, 0.0])


DEFAULTS = ParameterTable.defaults()


def table(**values: int) -> ParameterTable:
    return DEFAULTS.with_raw({key.replace("__", "."): value for key, value in values.items()})


def test_a_joint_moves_by_a_radian_to_either_side_unless_told_otherwise() -> None:
    limits = limits_of(load_arm("white_box"), DEFAULTS, POSE, {2: (-0.4, 0.6)})
    assert np.allclose(limits.low, [-WANTED.reach_rad, 0.45 - WANTED.reach_rad, -0.4, -WANTED.reach_rad])
    assert np.allclose(limits.high, [WANTED.reach_rad, 0.45 + WANTED.reach_rad, 0.6, WANTED.reach_rad])


def test_the_boards_limits_and_the_arms_stops_are_kept_with_a_margin() -> None:
    arm = load_arm("white_box")
    narrow = table(joint0__limit_max=1024, joint1__limit_min=0)
    limits = limits_of(arm, narrow, POSE, {0: (-6.0, 6.0), 3: (-6.0, 6.0)})
    assert limits.high[0] == pytest.approx(0.25 - WANTED.margin_rad)
    assert limits.low[1] == pytest.approx(WANTED.margin_rad)
    for joint in (0, 3):
        assert limits.low[joint] >= arm.joint[joint].stops.min + WANTED.margin_rad - 1e-12


def test_a_weaker_supply_means_slower_motion() -> None:
    arm = load_arm("default")
    strong = limits_of(arm, DEFAULTS, POSE, {})
    weak = limits_of(arm, table(supply_mv=7000), POSE, {})
    assert (weak.acceleration < 0.6 * strong.acceleration).all()
    assert (weak.speed <= strong.speed).all()


def test_a_pose_outside_its_range_and_a_range_without_width_are_refused() -> None:
    arm = load_arm("white_box")
    with pytest.raises(UserError, match=r"joint 1 is at 0\.45 rad, .*-0\.50 to 0\.30 rad"):
        limits_of(arm, DEFAULTS, POSE, {1: (-0.5, 0.3)})
    with pytest.raises(UserError, match="range of joint 3 is -0.05 to 0.05 rad"):
        limits_of(arm, DEFAULTS, POSE, {3: (-0.05, 0.05)})


def test_a_motor_that_cannot_lift_its_arm_is_named() -> None:
    with pytest.raises(UserError, match="motor of joint 1"):
        limits_of(load_arm("default"), table(joint1__ku_mv=300), POSE, {})


def test_the_family_begins_with_the_arm_and_is_the_same_for_a_seed() -> None:
    arm = load_arm("default")
    one, again, other = family(arm, 1), family(arm, 1), family(arm, 2)
    assert one.shape == (16, len(plant_row(arm)))
    assert np.allclose(one[0], plant_row(arm), rtol=1e-9)
    assert np.array_equal(one, again)
    assert not np.array_equal(one[1:], other[1:])


def test_the_family_of_a_model_is_drawn_from_its_covariance() -> None:
    sure = modelled(1e-3)
    there = family(sure, 0)[0] != 0.0
    spread = family(sure, 0)[1:, there] / family(sure, 0)[0, there]
    assert np.max(np.abs(spread - 1.0)) < 0.01
    doubtful = modelled(0.3)
    assert np.max(np.abs(family(doubtful, 0)[1:, there] / family(doubtful, 0)[0, there] - 1.0)) > 0.1


def modelled(deviation: float) -> ArmParameters:
    """The default arm as if its alphas had been identified with this deviation of their logarithms."""
    arm = load_arm("default")
    tables = [
        {"name": f"joint{joint}.alpha", "value": 1.0 / arm.actuator(joint).torque_per_volt, "white_box": 1.0}
        for joint in range(4)
    ]
    facts = {"covariance": np.diag(np.full(4, deviation**2)).tolist(), "parameter": tables}
    return arm.model_copy(update={"identification": facts})


@pytest.mark.parametrize(
    ("text", "words"),
    [(none, "") for none in ("1", "4:-1:1", "1:a:b", "1:-1:1:1")]
    + [(wrong, ".*±7 rad") for wrong in ("1:1:-1", "1:0:0", "1:-9:1", "1:nan:1")],
)
def test_a_range_that_is_none_or_empty_or_too_far_is_refused(text: str, words: str) -> None:
    with pytest.raises(UserError, match=f"--range is {words}") as refused:
        parse_range(text)
    assert refused.value.exit_code == BAD_USAGE
    assert parse_range("2:-0.5:0.75") == (2, (-0.5, 0.75))


def test_joints_that_are_not_in_use_stay_at_0() -> None:
    arm, board = load_arm("two_joints"), DEFAULTS.with_joints((0, 1))
    limits = limits_of(arm, board, np.zeros(4), {})
    assert np.all(limits.low[2:] == 0.0)
    assert np.all(limits.high[2:] == 0.0)
    assert np.all(limits.high[:2] > 0.5)
    assert np.all(family(arm)[:, columns("stop_max")][:, 2:] == 0.0)
    with pytest.raises(UserError, match="--range names joint 2, which is not in use"):
        limits_of(arm, board, np.zeros(4), {2: (-0.5, 0.5)})
    with pytest.raises(UserError, match="joints 0 and 1, .* all four joints"):
        limits_of(arm, DEFAULTS, np.zeros(4), {})
