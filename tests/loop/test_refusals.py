"""A wrong experiment gets one sentence that says what is wrong, and nothing is converted unasked."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.files.arm import default_arm
from greywhale.files.trajectory import Trajectory
from greywhale.loop import PLANT_COLUMNS, Experiment, Timing, default_controller, leader_slices, plant_row

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
    ("arguments", "sentence"),
    [
        ({"plants": PLANT.astype(np.float32)}, "plants are of type float32, but float64 is needed"),
        ({"plants": PLANT[:-1]}, r"shape \(\d+,\), but \(n, \d+\) or \(\d+,\) is needed"),
        ({"plants": PLANT.tolist()}, "plants must be a numpy array of float64, not a list"),
        ({"plants": changed(PLANT, "joint1.inertia", -0.1)}, r"plants\[0\]: joint1.inertia is -0.1, but it must be"),
        ({"plants": changed(PLANT, "supply", np.nan)}, "supply is nan, but it must be a finite number"),
        ({"plants": changed(PLANT, "joint2.stop_max", -3.0)}, "joint2.stop_max is -3, but it must not be below"),
        ({"plants": changed(PLANT, "joint3.breakaway", 0.0)}, "must not be below coulomb"),
        ({"plants": changed(PLANT, "joint0.stiffness", 0.0)}, "a gear with a gap needs teeth"),
        ({"controllers": default_controller().astype(np.int64)}, "of type int64, but int32 is needed"),
        ({"controllers": default_controller()[:3]}, r"shape \(3, 13\), but \(n, 4, 13\) or \(4, 13\)"),
        ({"controllers": default_controller() * 10}, r"controllers\[0, 0\]: ne_c is"),
        ({"controllers": np.zeros((3, 4, 13), np.int32) + default_controller(), "plants": np.stack([PLANT, PLANT])},
         "3 controllers and 2 plants"),
        ({"steps_per_tick": 3}, "steps_per_tick is 3, but it must be 1, 2 or 4"),
        ({"every": -1}, "neither may be negative"),
    ],
)  # fmt: skip
def test_wrong_candidates_are_refused(experiment: Experiment, arguments: dict[str, Any], sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        experiment.run(**arguments)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"weight_s": np.ones(3)}, "one weight for each of the"),
        ({"leader": np.zeros((7, 4))}, r"shape \(7, 4\), but \(4 x ticks, 4\)"),
        ({"leader": np.full((8, 4), np.nan)}, "joint 0 in slice 0 is nan; it must be finite"),
        (
            {"leader": np.full((8, 4), 3.0)},
            "starts with joint 0 at 3 rad, beyond the follower's stops of plants.0., -2.55 to 2.55",
        ),
    ],
)
def test_wrong_experiments_are_refused(arguments: dict[str, Any], sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        Experiment(**{"leader": motion(EVEN), "arm": default_arm(), **arguments}).run()


@pytest.mark.parametrize("wrong", [{"chain_start": 8000}, {"acts": (0, 1, 1, 1)}, {"drivers_on": 5}, {"late": -1}])
def test_wrong_timing_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(UserError, match=next(iter(wrong))):
        Timing(**wrong)
