"""The search: better than a hand, safe on every arm of the family, repeatable, and led by what a model leaves open."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.base.errors import BAD_USAGE, UserError
from greywhale.files.arm import load_arm
from greywhale.identify.excite import Problem, design
from greywhale.identify.limits import IDENTIFICATION_LIMITS
from greywhale.loop import human_reaches
from greywhale.protocol.table import ParameterTable
from tools.support.recordings import random_arm

POSE = (0.0, 0.45, -0.1, 0.0)
SECONDS = 8.0


@pytest.mark.slow
def test_a_design_tells_far_more_than_a_hand_and_is_safe_on_every_arm_of_its_family() -> None:
    made = design(random_arm(4), POSE, seconds=SECONDS, budget=40)
    rows = np.arange(0.0, SECONDS, 0.016)
    hands = [made.problem.judge(human_reaches(seed, SECONDS).at(rows)).log_det for seed in range(1, 6)]
    # Half of a log det is the volume of doubt: over 24 values e^12 means each known 1.6 times as well.
    assert 0.5 * made.judgement.log_det > 0.5 * max(hands) + 6.0
    assert 0.5 * made.judgement.log_det > 0.5 * float(np.median(hands)) + 10.0
    tried, limits = made.judgement.tried, made.problem.limits
    assert len(tried.angles) == 16
    assert tried.lag.max() <= limits.lag
    assert (tried.angles >= limits.low - IDENTIFICATION_LIMITS.excitation.margin_rad).all()
    assert (tried.angles <= limits.high + IDENTIFICATION_LIMITS.excitation.margin_rad).all()
    assert np.array_equal(made.motion.angles[0], np.array(POSE))
    assert np.allclose(made.motion.angles[-1], POSE, atol=1e-12)


def test_the_same_seed_makes_the_same_motion_and_another_one_another() -> None:
    def angles(seed: int) -> np.ndarray:
        return design(load_arm("white_box"), POSE, seconds=4.0, budget=8, seed=seed).motion.angles

    assert np.array_equal(angles(1), angles(1))
    assert not np.array_equal(angles(1), angles(2))


@pytest.mark.slow
def test_searching_pays() -> None:
    little, more = (design(load_arm("white_box"), POSE, seconds=5.0, budget=budget) for budget in (1, 50))
    assert more.judgement.log_det > little.judgement.log_det + 4.0


def test_with_a_model_the_motion_that_settles_what_is_open_wins() -> None:
    """Two motions, each of one joint. Which tells more depends on what is known already."""
    arm, still = load_arm("default"), np.tile(np.array(POSE), (400, 1))
    wave = 0.6 * np.sin(np.arange(400) * 0.06) * np.sin(np.arange(400) * np.pi / 399)
    only = {joint: still + wave[:, None] * (np.arange(4) == joint) for joint in (0, 3)}

    def better(open_joint: int) -> int:
        tables = [
            {"name": f"joint{joint}.{kind}", "value": value, "white_box": value}
            for joint in (0, 3)
            for kind, value in (
                ("alpha", 1.0 / arm.actuator(joint).torque_per_volt),
                ("damping", arm.actuator(joint).damping / arm.actuator(joint).torque_per_volt),
            )
        ]
        deviations = np.repeat([0.5 if joint == open_joint else 1e-4 for joint in (0, 3)], 2)
        facts = {"covariance": np.diag(deviations**2).tolist(), "parameter": tables}
        problem = Problem.of(
            arm.model_copy(update={"identification": facts}), ParameterTable.defaults(), np.array(POSE), {}, 0
        )
        return max(only, key=lambda joint: problem.judge(only[joint]).log_det)

    assert better(open_joint=0) == 0
    assert better(open_joint=3) == 3


def test_an_arm_that_would_lag_is_moved_less() -> None:
    """With weak controllers the follower is far behind; the motion is drawn together until it is not."""
    defaults = ParameterTable.defaults()
    lazy = defaults.with_raw({f"joint{joint}.kp": defaults[f"joint{joint}.kp"] // 3 for joint in range(4)})
    strong, weak = (
        design(load_arm("white_box"), POSE, table=table, seconds=5.0, budget=8) for table in (defaults, lazy)
    )
    assert weak.judgement.tried.lag.max() <= weak.problem.limits.lag
    assert np.ptp(weak.motion.angles, axis=0).sum() < 0.9 * np.ptp(strong.motion.angles, axis=0).sum()


def test_what_makes_no_sense_is_refused() -> None:
    arm = load_arm("white_box")
    for options, words in (
        ({"seconds": 2.0}, "length is 2 s"),
        ({"seconds": 1e4}, "length is 10000 s"),
        ({"budget": 0}, "budget"),
    ):
        with pytest.raises(UserError, match=words) as refused:
            design(arm, POSE, **options)
        assert refused.value.exit_code == BAD_USAGE


@pytest.mark.parametrize("name", ["joint7.alpha", "joint.alpha", "joint01.alpha", "joint1.glue"])
def test_a_model_with_a_parameter_that_nobody_knows_is_refused_by_its_name(name: str) -> None:
    facts = {"covariance": [[1.0]], "parameter": [{"name": name, "value": 1.0}]}
    with pytest.raises(UserError, match=f"'{name}'"):
        design(load_arm("white_box").model_copy(update={"identification": facts}), POSE)


def test_of_an_arm_with_fewer_joints_only_those_move() -> None:
    found = design(load_arm("two_joints"), np.zeros(4), seconds=4.0, budget=8)
    assert np.all(found.motion.angles[:, 2:] == 0.0)
    assert np.ptp(found.motion.angles, axis=0)[:2].min() > 0.3
    assert {one.joint for one in found.problem.parameters} == {0, 1}
