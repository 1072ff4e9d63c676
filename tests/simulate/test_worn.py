"""Arms with play, load friction, creep, lag and a sagging supply: batch, exact run and compiled firmware agree."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm.plants import column, columns
from greywhale.files.arm import default_arm, load_arm
from greywhale.motion import human_reaches, multi_steps
from greywhale.simulate import Experiment, plant_row
from tests.simulate.on_the_bench import quiet, record
from tests.simulate.test_on_the_bench import native, require_same_duties

RIGID = {"half_gap": 0.0, "stiffness": 0.0}
WEAR: dict[str, dict[str, float]] = {
    "load friction": {"load_friction": 0.35},
    "creep": {"creep_velocity": 0.02},
    "play": {"pot_play": 0.01},
    "lag": {"pot_lag": 0.002},
    "supply": {"supply_resistance": 0.6},
    "all": {
        "load_friction": 0.35,
        "creep_velocity": 0.02,
        "pot_play": 0.01,
        "pot_lag": 0.002,
        "supply_resistance": 0.3,
    },
}
WEAR |= {"rigid, load friction": RIGID | WEAR["load friction"], "rigid, all": RIGID | WEAR["all"]}


@pytest.fixture(scope="module")
def experiment() -> Experiment:
    return Experiment(human_reaches(4, 3.0), default_arm(), noise=False)


@pytest.mark.parametrize("wear", list(WEAR))
def test_batch_follows_the_single_run(experiment: Experiment, wear: str) -> None:
    plant = plant_row(default_arm())
    sound = experiment.run(None, plant, every=1, steps_per_tick=4)
    for name, value in WEAR[wear].items():
        plant[[column(name)] if name == "supply_resistance" else columns(name)] = value
    batch, exact = experiment.run(None, plant, every=1, steps_per_tick=4), experiment.run_exact(None, plant, every=1)
    assert np.abs(exact.angles - sound.angles).max() > 1e-3, "the wear changes nothing, so nothing is compared"
    moving = 3000  # until some reading tips over
    assert (batch.duties != exact.duties)[0, :moving].mean() < 0.02
    np.testing.assert_allclose(batch.angles[0, :moving], exact.angles[0, :moving], atol=2e-3)
    np.testing.assert_allclose(batch.mse, exact.mse, rtol=0.02)


def test_sound_plants_keep_every_bit_beside_worn_ones(experiment: Experiment) -> None:
    plants = np.repeat(plant_row(default_arm())[None], 20, axis=0)
    alone = experiment.run(None, plants, every=5)
    plants[1::2, columns("load_friction")] = 0.3
    plants[1::2, columns("creep_velocity")] = 0.01
    plants[1::2, columns("pot_play")] = 0.01
    plants[1::2, column("supply_resistance")] = 0.3
    beside = experiment.run(None, plants, every=5)
    assert (beside.duties[1] != alone.duties[1]).any()
    np.testing.assert_array_equal(beside.angles[::2], alone.angles[::2])
    np.testing.assert_array_equal(beside.duties[::2], alone.duties[::2])


@pytest.mark.slow
def test_worn_arm_gets_the_same_duties_from_the_compiled_firmware() -> None:
    parameters = quiet(load_arm("worn"))
    recording = record(parameters, multi_steps([0.0, 0.5, -0.3, 0.4], [0.55, 1.5, 1.5, 1.5]), 6.0)
    require_same_duties(recording, native(recording, parameters).run_exact(every=1))
