"""A wrong experiment gets one sentence that says what is wrong, and nothing is converted unasked."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.files.arm import default_arm
from greywhale.files.trajectory import Trajectory
from greywhale.loop import PLANT_COLUMNS, Experiment, Timing, default_controller, leader_slices, plant_row
from tests.support.sentences import names

EVEN = np.arange(50) * 0.02


def motion(time_s: np.ndarray) -> Trajectory:
    return Trajectory(time_s, np.sin(time_s)[:, None] * np.ones(4) * 0.3)


@pytest.fixture(scope="module")
def experiment() -> Experiment:
    return Experiment(motion(EVEN), default_arm(), wait_s=0.1)


def test_even_recordings_are_taken_and_gaps_and_uneven_times_refused() -> None:
    assert len(leader_slices(motion(EVEN), 0.0)) == 4 * 980
    gap = np.concatenate([EVEN[:20], EVEN[25:]])
    with pytest.raises(UserError, match=r"has a gap: 0.5 s follows 0.38 s, elsewhere rows are 0.02 s apart"):
        leader_slices(motion(gap), 0.0)
    uneven = EVEN.copy()
    uneven[10] += 0.004
    with pytest.raises(UserError, match="uneven time"):
        leader_slices(motion(uneven), 0.0)
    bridged = leader_slices(motion(gap), 0.0, resample=True)
    np.testing.assert_allclose(bridged, leader_slices(motion(EVEN), 0.0), atol=0.003)


def changed(row: np.ndarray, column: str, value: float) -> np.ndarray:
    copy = row.copy()
    copy[PLANT_COLUMNS.index(column)] = value
    return copy


PLANT = plant_row(default_arm())


@pytest.mark.parametrize(
    ("arguments", "things"),
    [
        ({"plants": PLANT.astype(np.float32)}, "plants float32 float64"),
        ({"plants": PLANT[:-1]}, f"plants ({len(PLANT) - 1},) (n, {len(PLANT)})"),
        ({"plants": PLANT.tolist()}, "plants float64 list"),
        ({"plants": changed(PLANT, "joint1.inertia", -0.1)}, "plants[0] joint1.inertia -0.1"),
        ({"plants": changed(PLANT, "supply", np.nan)}, "plants[0] supply nan finite"),
        ({"plants": changed(PLANT, "joint2.stop_max", -3.0)}, "plants[0] joint2.stop_max -3 below"),
        ({"plants": changed(PLANT, "joint3.breakaway", 0.0)}, "plants[0] joint3.breakaway 0 coulomb"),
        ({"plants": changed(PLANT, "joint0.stiffness", 0.0)}, "plants[0] joint0.stiffness 0 gap teeth"),
        ({"controllers": default_controller().astype(np.int64)}, "controllers int64 int32"),
        ({"controllers": default_controller()[:3]}, "controllers (3, 13) (n, 4, 13)"),
        ({"controllers": default_controller() * 10}, "controllers[0, 0] ne_c"),
        ({"controllers": np.stack([default_controller()] * 3), "plants": np.stack([PLANT] * 2)}, "3 2"),
        ({"steps_per_tick": 3}, "steps_per_tick 3 1 2 4"),
        ({"every": -1}, "every -1"),
    ],
)
def test_wrong_candidates_are_refused(experiment: Experiment, arguments: dict[str, Any], things: str) -> None:
    with pytest.raises(UserError) as refused:
        experiment.run(**arguments)
    assert names(refused.value.message, things)


@pytest.mark.parametrize(
    ("arguments", "things"),
    [
        ({"weight_s": np.ones(3)}, "weight_s float64 2480"),
        ({"leader": np.zeros((7, 4))}, "(7, 4) (4 x ticks, 4)"),
        ({"leader": np.full((8, 4), np.nan)}, "joint 0 slice 0 nan finite"),
        ({"leader": np.full((8, 4), 3.0)}, "joint 0 3 rad stops plants[0] -2.55 2.55"),
    ],
)
def test_wrong_experiments_are_refused(arguments: dict[str, Any], things: str) -> None:
    with pytest.raises(UserError) as refused:
        Experiment(**{"leader": motion(EVEN), "arm": default_arm(), **arguments}).run()
    assert names(refused.value.message, things)


@pytest.mark.parametrize("wrong", [{"chain_start": 8000}, {"acts": (0, 1, 1, 1)}, {"drivers_on": 5}, {"late": -1}])
def test_wrong_timing_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(UserError, match=next(iter(wrong))):
        Timing(**wrong)
