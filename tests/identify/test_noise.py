"""The potentiometers' noise comes out of a log, and stands in the model for whoever tunes on it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.arm.from_plant import arm_of
from greywhale.files.arm import default_arm, load_arm
from greywhale.identify.data import pot_noise, prepare
from greywhale.loop import human_reaches, plant_row
from tools.support.recordings import random_arm, record, table_of


@pytest.mark.parametrize(("seed", "every", "low"), [(1, 1, 0.9), (9, 4, 0.75)])
def test_noise_is_told_from_motion(tmp_path: Path, seed: int, every: int, low: float) -> None:
    """A quiet arm, whose converter steps are as large as its noise, and a noisy one; of every fourth tick more is
    smoothed away.
    """
    arm = random_arm(seed)
    truth = np.array([pot.noise for pot in arm.follower_pots.joint])
    log = record(arm, human_reaches(3, 6.0), tmp_path / "log.csv", table_of("before_tuning"), 3, every)
    found = pot_noise(prepare(log, 1), 1, 5.0)
    assert np.all((low * truth < found) & (found < 1.2 * truth))


def test_model_has_the_noise_on_both_arms_and_nothing_else_changed() -> None:
    arm = load_arm("white_box")
    noise = np.array([0.001, 0.002, 0.003, 9.0])
    model = arm_of(arm, plant_row(arm), np.zeros(4), "model", "test", noise)
    assert [pot.noise for pot in model.follower_pots.joint] == pytest.approx([0.001, 0.002, 0.003, 0.5])
    assert [pot.noise for pot in model.leader_pots.joint] == pytest.approx([0.001, 0.002, 0.003, 0.5])
    np.testing.assert_array_equal(plant_row(model), plant_row(arm_of(arm, plant_row(arm), np.zeros(4), "a", "b")))


def test_leader_keeps_noise_that_the_arm_file_knows_to_be_higher() -> None:
    arm = default_arm()
    model = arm_of(arm, plant_row(arm), np.zeros(4), "model", "test", np.full(4, 1e-4))
    assert [pot.noise for pot in model.leader_pots.joint] == [pot.noise for pot in arm.leader_pots.joint]
    assert [pot.noise for pot in model.follower_pots.joint] == pytest.approx([1e-4] * 4)
