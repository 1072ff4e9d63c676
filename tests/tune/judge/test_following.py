"""Joints that follow worse than before are named, and chosen only for much that they gain, or for calm."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greywhale.files.arm import default_arm
from greywhale.loop import default_controller, human_reaches, plant_row
from greywhale.protocol.table import ParameterTable
from greywhale.tune.judge.following import FollowingBefore, worse_followers
from greywhale.tune.limits import TUNING_LIMITS
from greywhale.tune.possible import scale_of
from greywhale.tune.search.objective import Objective
from greywhale.tune.search.training import TrainingMotion, abrupt_moves, own_motion

PLANT = plant_row(default_arm())
BEFORE = default_controller()


def drill(name: str) -> TrainingMotion:
    return replace(own_motion(human_reaches(4, 2.0), default_arm(), ParameterTable.defaults(), PLANT[None]), name=name)


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
    ("before", "after", "named"), [(1e-4, 1.04e-4, False), (1e-3, 1.1e-3, True), (1e-8, 5e-8, False)]
)
def test_what_nobody_would_see_is_not_named(before: float, after: float, named: bool) -> None:
    class Motion:
        name, mse_before, mse_after = "steps", np.full(4, before), np.array([after, *[before] * 3])

    motion: Any = Motion()
    found = worse_followers([motion], (), PLANT, BEFORE, BEFORE, (0, 1, 2, 3))
    assert [one.joint for one in found] == [0] * named


def test_only_a_joint_that_hunts_follows_a_class_of_motions_less_closely_for_nothing() -> None:
    drills, plants = [drill("reaches")], PLANT[None]
    objective = Objective(drills, plants, scale_of(drills, plants, BEFORE))
    weak = BEFORE.copy()
    weak[[1, 2], 11] //= 3
    hunts = np.array([False, True, False, False])
    rows = np.stack([BEFORE, weak])
    for exact in (False, True):
        before = FollowingBefore.of(objective, drill("abrupt moves"), BEFORE, hunts, exact)
        prices = before.price(objective.follow(rows, exact), rows)
        assert not prices[0].any()
        assert not prices[1, [0, 1, 3]].any(), "joint 1 hunted, and neighbours hardly notice"
        assert prices[1, 2] > TUNING_LIMITS.following.behind_price
        outweighed = before.outweighs(objective.costs(rows, exact))
        np.testing.assert_array_equal(outweighed, [[False] * 4, [False, False, True, False]])


def test_abrupt_moves_count_though_nobody_trains_on_them() -> None:
    """A joint that follows only these less closely pays, too."""
    drills, plants = [drill("reaches")], PLANT[None]
    objective = Objective(drills, plants, scale_of(drills, plants, BEFORE))
    edges = abrupt_moves(default_arm(), ParameterTable.defaults(), plants, 0.01, 0, TUNING_LIMITS.training)
    before = FollowingBefore.of(objective, edges, BEFORE, np.zeros(4, dtype=bool), exact=False)
    found = objective.follow(BEFORE[None])
    slower = replace(before, error=before.error * np.array([[1.0], [0.5]]))
    assert not before.price(found, BEFORE[None]).any()
    assert (slower.price(found, BEFORE[None]) > 0.5).all()
