"""The objective cannot be won by doing nothing, weighs each class by what is possible, and trains to both sides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greywhale.arm.plants import column
from greywhale.base.errors import UserError
from greywhale.files.arm import default_arm
from greywhale.files.trajectory import Trajectory
from greywhale.loop import default_controller, human_reaches, plant_row
from greywhale.measure.limits import SWING_BOUNDS
from greywhale.protocol.table import ParameterTable
from greywhale.tune.limits import TUNING_LIMITS
from greywhale.tune.possible import scale_of
from greywhale.tune.search.objective import (
    ErrorScale,
    FollowingErrors,
    Objective,
    follow,
    pair_with_plants,
    relative_costs,
    total_costs,
)
from greywhale.tune.search.training import (
    fit_motion,
    moves,
    reach,
    slow_following,
    time_since_move,
    training_motions,
)

COST, TRAINING = TUNING_LIMITS.cost, TUNING_LIMITS.training
ARM = default_arm()
PLANTS = plant_row(ARM)[None]
BEFORE = default_controller()


@pytest.fixture(scope="module")
def objective() -> Objective:
    motions = training_motions(ARM, ParameterTable.defaults(), PLANTS)
    return Objective(motions, PLANTS, scale_of(motions, PLANTS, BEFORE))


def test_doing_nothing_costs_more_than_anything_sensible(objective: Objective) -> None:
    idle = BEFORE.copy()
    idle[:, 11] = 0
    nothing, before = objective.costs(np.stack([idle, BEFORE]))
    assert (nothing > 2.0 * before).all()


def test_the_effort_is_a_small_part_of_the_cost(objective: Objective) -> None:
    found = follow(objective.drills, PLANTS, BEFORE[None])
    all_of_it = relative_costs(found, objective.scale, 15.0)
    without = relative_costs(replace(found, volts=0.0 * found.volts), objective.scale, 15.0)
    assert (all_of_it > without).all()
    assert (all_of_it - without < 0.01 * all_of_it).all()


def test_fine_following_counts_as_much_as_large_moves() -> None:
    """Half of what can be avoided costs the same in a class whose errors are ten times as large."""
    floor, room = np.zeros((1, 2, 4)), np.stack([np.full(4, 0.1), np.full(4, 0.01)])[None]
    scale = ErrorScale(floor + np.array([0.3, 0.0])[:, None], room, np.zeros((1, 2, 4)))
    none = np.zeros((1, 1, 2, 4))
    found = FollowingErrors(scale.floor[None] + 0.5 * room[None], none, none, none)
    np.testing.assert_allclose(relative_costs(found, scale, 15.0), np.sqrt(0.5))


def test_large_moves_count_half_and_fine_following_the_other_half(objective: Objective) -> None:
    shares = {drill.name: drill.importance for drill in objective.drills}
    assert shares["moves to both sides"] == shares["human-like reaches"] + shares["slow following"]
    found = follow(objective.drills, PLANTS, BEFORE[None])
    large, human, slow = relative_costs(found, objective.scale, 15.0)[0, 0]
    np.testing.assert_allclose(objective.costs(BEFORE[None])[0], 0.5 * large + 0.25 * (human + slow))


def test_rattling_and_chatter_cost_most_beyond_what_was_before_and_near_the_margin() -> None:
    floor, room, before = np.zeros((1, 2, 4)), np.full((1, 2, 4), 0.05), np.full((1, 2, 4), 0.002)
    scale, none = ErrorScale(floor, room, before), np.zeros((1, 1, 2, 4))
    quiet, loud, chattering = none.copy(), none.copy(), none.copy()
    quiet[0, 0, 1, 3], loud[0, 0, 1, 3], chattering[0, 0, 0, 2] = 0.002, 0.003, 170.0
    costs = [relative_costs(FollowingErrors(none, none, rattle, none), scale, 15.0) for rattle in (quiet, loud)]
    assert costs[0][0, 0, 1, 3] == pytest.approx(np.sqrt(COST.rattle_weight * 0.002 / 0.05))
    assert costs[1][0, 0, 1, 3] == pytest.approx(
        np.sqrt(COST.rattle_weight * (0.003 + COST.louder_weight * 0.001) / 0.05)
    )
    assert np.count_nonzero(costs[1]) == 1
    beaten = relative_costs(FollowingErrors(none, none, none, chattering), scale, 15.0)
    assert beaten[0, 0, 0, 2] == pytest.approx(np.sqrt(COST.chatter_weight * 1.0))
    silent = replace(scale, rattle=np.zeros((1, 2, 4)))
    free = relative_costs(FollowingErrors(none, none, np.full_like(none, COST.unheard_rad), none), silent, 15.0)
    np.testing.assert_allclose(free, np.sqrt(COST.rattle_weight * COST.unheard_rad / 0.05))
    always = replace(scale, rattle=np.full((1, 2, 4), SWING_BOUNDS.rattle_moving_rad))
    shaken = relative_costs(FollowingErrors(none, none, always.rattle[:, None], none), always, 15.0)
    np.testing.assert_allclose(
        shaken,
        np.sqrt(
            COST.rattle_weight * SWING_BOUNDS.rattle_moving_rad / 0.05
            + COST.shaking_weight * (1.0 - COST.bearable_share)
        ),
    )


def test_a_joint_that_is_tuned_one_sidedly_pays(objective: Objective) -> None:
    """Good to the right and slow to the left must cost more than good to both sides."""
    good, lame = BEFORE.copy(), BEFORE.copy()
    lame[:, 0] = lame[:, 0] * 3  # NE reaches three times as far: little voltage for negative errors
    one, other = objective.costs(np.stack([good, lame]))
    assert (other > one).all()


def test_the_bench_s_own_arithmetic_agrees(objective: Objective) -> None:
    batch, exact = objective.costs(BEFORE[None]), objective.costs(BEFORE[None], exact=True)
    np.testing.assert_allclose(batch, exact, rtol=0.03)


def test_the_plants_mean_and_worst_count_half_each() -> None:
    values = np.array([[[1.0, 0.0, 2.0, 4.0], [3.0, 0.0, 2.0, 0.0]]])
    np.testing.assert_allclose(
        total_costs(values[:, :, None], [1.0]), [[0.5 * 2 + 0.5 * 3, 0.0, 2.0, 0.5 * 2 + 0.5 * 4]]
    )


def test_every_controller_meets_every_plant() -> None:
    laws, arms = pair_with_plants(np.stack([BEFORE, BEFORE + 1]), np.array([[1.0], [2.0], [3.0]]))
    assert arms[:, 0].tolist() == [1, 2, 3, 1, 2, 3]
    assert (laws[:3] == BEFORE).all()
    assert (laws[3:] == BEFORE + 1).all()


def test_moves_go_to_both_sides_in_several_sizes() -> None:
    motion = moves(np.full(4, -2.0), np.full(4, 2.0))
    assert motion.angles.max(axis=0) == pytest.approx(np.ones(4))
    assert motion.angles.min(axis=0) == pytest.approx(-np.ones(4))
    for steps in (-np.diff(TRAINING.levels), np.diff(TRAINING.levels)):
        assert sum(steps > 0) >= 3
        assert steps[steps > 0].min() <= 0.1 + 1e-9
        assert steps.max() >= 1.0
    assert len(np.unique(motion.angles[::40].round(3), axis=1)[0]) == 4, "each joint goes its own way"


def test_the_weight_starts_again_with_every_move() -> None:
    time_s = np.arange(601) / 200.0
    angle = np.where(time_s < 1.0, 0.0, np.where(time_s < 2.0, 0.5, 1.0))
    weight = time_since_move(Trajectory(time_s, np.tile(angle[:, None], 4)), 0.5)
    assert len(weight) == 3500
    assert (weight[:500] == 0.0).all()
    assert weight[500] == pytest.approx(TRAINING.soon_s)
    # A move is over when nothing changed for 0.1 s.
    assert weight[1450] == pytest.approx(TRAINING.soon_s + 0.95, abs=0.01)
    assert weight[1550] == pytest.approx(TRAINING.soon_s, abs=0.01)
    assert weight[2450] == pytest.approx(TRAINING.soon_s + 0.85, abs=0.02)
    assert weight[2550] == pytest.approx(TRAINING.soon_s, abs=0.01)


def test_a_trembling_hand_is_at_rest() -> None:
    time_s = np.arange(401) / 200.0
    tremor = 0.003 * np.sin(2 * np.pi * 10.0 * time_s)
    weight = time_since_move(Trajectory(time_s, np.tile(tremor[:, None], 4)), 0.0)
    assert weight[-1] == pytest.approx(TRAINING.soon_s + 2.0, abs=0.01)


def test_motions_keep_within_limits_and_stops() -> None:
    table = ParameterTable.defaults().with_raw({"joint1.limit_max": round(0.5 * 4096)})
    plants = PLANTS.copy()
    plants[0, column("stop_min", 3)] = -0.4
    low, high = reach(ARM, table, plants)
    for drill in training_motions(ARM, table, plants):
        leader = drill.experiment.leader
        assert (leader >= low - 1e-9).all()
        assert (leader <= high + 1e-9).all()
        assert (np.ptp(leader, axis=0) > 0.2).all()
    assert leader[:, 1].max() <= 0.5
    assert leader[:, 3].min() >= -0.4


def test_reaches_are_moved_into_the_range_and_only_made_smaller_where_it_is_narrower() -> None:
    reaches = human_reaches(3, 4.0)
    least, most = reaches.angles.min(axis=0), reaches.angles.max(axis=0)
    np.testing.assert_array_equal(fit_motion(reaches, least - 0.1, most + 0.1).angles, reaches.angles)
    np.testing.assert_allclose(fit_motion(reaches, least + 0.2, most + 0.3).angles, reaches.angles + 0.2)
    np.testing.assert_allclose(fit_motion(reaches, least - 0.3, most - 0.2).angles, reaches.angles - 0.2)
    narrow = fit_motion(reaches, 0.5 * least, 0.5 * most).angles
    np.testing.assert_allclose(narrow, 0.5 * reaches.angles, atol=1e-9)
    assert (fit_motion(reaches, np.zeros(4), np.zeros(4)).angles == 0.0).all(), "a joint that is not in use rests"


def test_a_joint_without_room_is_refused() -> None:
    table = ParameterTable.defaults().with_raw({"joint2.limit_max": -9000})
    with pytest.raises(UserError, match="joint 2 has no room to move: limits -2.5 to -2.19"):
        reach(ARM, table, PLANTS)


def test_slow_following_is_small_and_slow_and_lets_each_joint_rest_in_turn() -> None:
    motion = slow_following(np.full(4, -2.0), np.full(4, 2.0))
    speed = np.diff(motion.angles, axis=0) * 200.0
    assert (np.ptp(motion.angles, axis=0) > 0.15).all()
    assert (np.ptp(motion.angles, axis=0) < 0.4).all()
    assert np.abs(speed).max() < 0.6
    resting = np.array(
        [[np.abs(speed[400 * k + 100 : 400 * k + 300, j]).max() < 1e-9 for j in range(4)] for k in range(4)]
    )
    np.testing.assert_array_equal(resting, np.eye(4, dtype=bool))
    narrow = slow_following(np.full(4, 0.3), np.full(4, 0.5)).angles
    assert narrow.min() >= 0.3
    assert narrow.max() <= 0.5
    assert (np.ptp(narrow, axis=0) > 0.099).all()
