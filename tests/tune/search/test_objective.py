"""The objective cannot be won by doing nothing, and trains to both sides in several sizes."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm.plants import column
from greywhale.errors import UserError
from greywhale.files.arm import default_arm
from greywhale.loop import default_controller, plant_row
from greywhale.table import ParameterTable
from greywhale.trajectory import Trajectory
from greywhale.tune.search.objective import EFFORT, RMS, Objective, combine_plants, pair_with_plants
from greywhale.tune.search.training import LEVELS, SOON_S, drills, moves, reach, time_since_move

ARM = default_arm()
PLANTS = plant_row(ARM)[None]
BEFORE = default_controller()


@pytest.fixture(scope="module")
def objective() -> Objective:
    return Objective(drills(ARM, ParameterTable.defaults(), PLANTS), PLANTS)


def test_doing_nothing_costs_more_than_anything_sensible(objective: Objective) -> None:
    idle = BEFORE.copy()
    idle[:, 11] = 0
    nothing, before = objective.costs(np.stack([idle, BEFORE]))
    assert (nothing > 2.0 * before).all()
    assert (nothing > 0.5).all(), "rad, about the distance that the leader goes"


def test_the_effort_is_a_small_part_of_the_cost(objective: Objective) -> None:
    found = objective.tracking(BEFORE[None])
    parts = np.stack([found.error, RMS * np.sqrt(found.square), EFFORT * found.volts])
    np.testing.assert_allclose(objective.costs(BEFORE[None])[0], parts.sum(axis=0)[0, 0])
    assert (parts[2] < 0.01 * parts.sum(axis=0)).all()


def test_a_joint_that_is_tuned_one_sidedly_pays(objective: Objective) -> None:
    """Good to the right and slow to the left must cost more than good to both sides."""
    good, lame = BEFORE.copy(), BEFORE.copy()
    lame[:, 0] = lame[:, 0] * 3  # NE reaches three times as far: little voltage for negative errors
    one, other = objective.costs(np.stack([good, lame]))
    assert (other > one).all()


def test_the_bench_s_own_arithmetic_agrees(objective: Objective) -> None:
    batch, single = objective.costs(BEFORE[None]), objective.costs(BEFORE[None], single=True)
    np.testing.assert_allclose(batch, single, rtol=0.03)


def test_the_plants_mean_and_worst_count_half_each() -> None:
    values = np.array([[[1.0, 0.0, 2.0, 4.0], [3.0, 0.0, 2.0, 0.0]]])
    np.testing.assert_allclose(combine_plants(values), [[0.5 * 2 + 0.5 * 3, 0.0, 2.0, 0.5 * 2 + 0.5 * 4]])


def test_every_controller_meets_every_plant() -> None:
    laws, arms = pair_with_plants(np.stack([BEFORE, BEFORE + 1]), np.array([[1.0], [2.0], [3.0]]))
    assert arms[:, 0].tolist() == [1, 2, 3, 1, 2, 3]
    assert (laws[:3] == BEFORE).all()
    assert (laws[3:] == BEFORE + 1).all()


def test_moves_go_to_both_sides_in_several_sizes() -> None:
    motion = moves(np.full(4, -2.0), np.full(4, 2.0))
    for joint in range(4):
        angles = motion.angles[:, joint]
        places = angles[np.flatnonzero(np.abs(np.diff(angles, prepend=np.inf)) > 0) - 1]
        assert angles.max() == pytest.approx(1.0)
        assert angles.min() == pytest.approx(-1.0)
        assert len(places) > 10
    sizes = np.abs(np.diff(LEVELS))
    assert sizes.min() <= 0.1 + 1e-9
    assert sizes.max() >= 1.0
    assert sum(np.diff(LEVELS) > 0) >= 3
    assert sum(np.diff(LEVELS) < 0) >= 3
    assert len(np.unique(motion.angles[::40].round(3), axis=1)[0]) == 4, "each joint goes its own way"


def test_the_weight_starts_again_with_every_move() -> None:
    time_s = np.arange(601) / 200.0
    angle = np.where(time_s < 1.0, 0.0, np.where(time_s < 2.0, 0.5, 1.0))
    weight = time_since_move(Trajectory(time_s, np.tile(angle[:, None], 4)), 0.5)
    assert len(weight) == 3500
    assert (weight[:500] == 0.0).all()
    assert weight[500] == pytest.approx(SOON_S)
    # A move is over when nothing changed for 0.1 s.
    assert weight[1450] == pytest.approx(SOON_S + 0.95, abs=0.01)
    assert weight[1550] == pytest.approx(SOON_S, abs=0.01)
    assert weight[2450] == pytest.approx(SOON_S + 0.85, abs=0.02)
    assert weight[2550] == pytest.approx(SOON_S, abs=0.01)


def test_a_trembling_hand_is_at_rest() -> None:
    time_s = np.arange(401) / 200.0
    tremor = 0.003 * np.sin(2 * np.pi * 10.0 * time_s)
    weight = time_since_move(Trajectory(time_s, np.tile(tremor[:, None], 4)), 0.0)
    assert weight[-1] == pytest.approx(SOON_S + 2.0, abs=0.01)


def test_motions_keep_within_limits_and_stops() -> None:
    table = ParameterTable.defaults().with_raw({"joint1.limit_max": round(0.5 * 4096)})
    plants = PLANTS.copy()
    plants[0, column("stop_min", 3)] = -0.4
    low, high = reach(ARM, table, plants)
    for drill in drills(ARM, table, plants):
        leader = drill.experiment.leader
        assert (leader >= low - 1e-9).all()
        assert (leader <= high + 1e-9).all()
        assert (np.ptp(leader, axis=0) > 0.3).all()
    assert leader[:, 1].max() <= 0.5
    assert leader[:, 3].min() >= -0.4


def test_a_joint_without_room_is_refused() -> None:
    table = ParameterTable.defaults().with_raw({"joint2.limit_max": -9000})
    with pytest.raises(UserError, match="joint 2 has no room to move: limits -2.5 to -2.19"):
        reach(ARM, table, PLANTS)
