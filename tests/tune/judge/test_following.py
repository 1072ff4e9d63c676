"""Joints that follow worse than before are named, and never chosen unless they hunted."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greywhale.files.arm import default_arm
from greywhale.loop import Experiment, default_controller, human_reaches, plant_row
from greywhale.tune.judge.following import ErrorsBefore, worse_followers
from greywhale.tune.limits import TUNING_LIMITS
from greywhale.tune.search.objective import FollowingErrors
from greywhale.tune.search.training import TrainingMotion

PLANT = plant_row(default_arm())
BEFORE = default_controller()


def drill(name: str) -> TrainingMotion:
    motion = human_reaches(4, 2.0)
    return TrainingMotion(name, motion, Experiment(motion, default_arm(), noise=False, soft_start=False), 1.0, 1.0)


def test_a_joint_that_follows_worse_is_named_with_motion_and_factor() -> None:
    weak = BEFORE.copy()
    weak[2, 11] //= 3
    (found,) = worse_followers((), [drill("reaches")], PLANT, BEFORE, weak, (0, 1, 2, 3))
    assert (found.joint, found.motion) == (2, "reaches")
    assert found.times > 1.5
    assert found.words == f"joint 2 (wrist pitch) on reaches, {found.times:.2g} times the error"
    assert worse_followers((), [drill("reaches")], PLANT, weak, BEFORE, (0, 1, 2, 3)) == ()
    assert worse_followers((), [drill("reaches")], PLANT, BEFORE, weak, (0, 1)) == (), "one not in use follows nobody"


@pytest.mark.parametrize(
    ("before", "after", "named"), [(1e-4, 1.09e-4, False), (1e-4, 1.3e-4, True), (1e-8, 5e-8, False)]
)
def test_what_nobody_would_see_is_not_named(before: float, after: float, named: bool) -> None:
    class Motion:
        name, mse_before, mse_after = "steps", np.full(4, before), np.array([after, *[before] * 3])

    motion: Any = Motion()
    found = worse_followers([motion], (), PLANT, BEFORE, BEFORE, (0, 1, 2, 3))
    assert [one.joint for one in found] == [0] * named


def test_only_a_joint_that_hunts_may_follow_a_class_of_motions_less_closely() -> None:
    hunts = np.array([False, False, True, False])
    errors = ErrorsBefore(np.full((2, 4), 0.1), hunts)
    allowed = TUNING_LIMITS.following.error_slack * 0.1 + TUNING_LIMITS.cost.least_room_rad
    error = np.full((1, 3, 2, 4), 0.05)
    error[0, 0, 1] = [allowed, 1.1 * allowed, 9.0 * allowed, 0.1]
    error[0, 1:, :, 3] = 1.0  # other plants are no promise
    none = np.zeros_like(error)
    excess = errors.excess(FollowingErrors(error, none, none, none))
    np.testing.assert_allclose(excess, [[0.0, 0.1, 0.0, 0.0]], atol=1e-12)
