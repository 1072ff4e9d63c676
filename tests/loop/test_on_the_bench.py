"""The native simulation does what the compiled firmware does on the bench, also with a worn arm."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.arm.plants import column, columns
from greywhale.files.arm import default_arm, load_arm
from greywhale.loop import Experiment, Result, human_reaches, multi_steps, plant_row
from greywhale.protocol.schema import Board
from greywhale.protocol.table import ParameterTable
from tests.loop.on_the_bench import Recording, quiet, record

PWM_TOP = {"mega": np.array([400, 400, 400, 400]), "nano": np.array([400, 400, 255, 255])}
SLICES_PER_TICK = 4
HAND_S = 1.5  # the leader waits that long after enable


def native(recording: Recording, parameters: ArmParameters, board: str = "mega", noise: bool = False) -> Experiment:
    slices = len(recording.leader) // SLICES_PER_TICK * SLICES_PER_TICK
    return Experiment(
        np.ascontiguousarray(recording.leader[:slices]),
        parameters,
        table=ParameterTable.defaults(Board.NANO328 if board == "nano" else Board.MEGA2560),
        noise=noise,
        timing=recording.timing,
        gap_position=list(recording.gap_position),
    )


def require_same_duties(recording: Recording, result: Result, board: str = "mega") -> None:
    duties = result.duties[0].astype(float) / PWM_TOP[board]
    for joint in range(4):
        seen = recording.duties[recording.timing.acts[joint] :: SLICES_PER_TICK, joint]
        ticks = min(len(seen), len(duties))
        np.testing.assert_allclose(seen[:ticks], duties[:ticks, joint], rtol=0, atol=1e-9)
        assert len(np.unique(seen)) > 50, "the joint was hardly driven, so little was compared"


@pytest.mark.slow
@pytest.mark.parametrize("board", ["mega", "nano"])
def test_without_noise_the_duties_are_the_same_from_enable_on(board: str) -> None:
    """Soft start, large and small motions, stiction and backlash of the default arm: every duty of every tick."""
    parameters = quiet(default_arm())
    recording = record(parameters, human_reaches(3, 6.0), 6.0, board)
    result = native(recording, parameters, board).run_exact(every=1)
    require_same_duties(recording, result, board)
    bench_angles = recording.angles[::SLICES_PER_TICK][: len(result.angles[0])]
    np.testing.assert_allclose(bench_angles, result.angles[0], rtol=0, atol=1e-6)


@pytest.mark.slow
def test_with_noise_the_errors_are_the_same_within_two_percent() -> None:
    parameters = default_arm()
    recording = record(parameters, multi_steps([0.0, 0.8, -0.4, 0.5], [1.0, 2.0, 2.0, 2.0]), 1.5 + HAND_S + 6.0)
    bench_error = recording.leader[::SLICES_PER_TICK] - recording.angles[::SLICES_PER_TICK]
    result = native(recording, parameters, noise=True).run_exact()
    np.testing.assert_allclose(result.mse[0], (bench_error**2).mean(axis=0), rtol=0.02)


RIGID = {"half_gap": 0.0, "stiffness": 0.0}
WEAR: dict[str, dict[str, float]] = {
    "load friction": {"load_friction": 0.35},
    "creep": {"creep_velocity": 0.02},
    "play": {"pot_play": 0.01},
    "lag": {"pot_lag": 0.002},
    "supply": {"supply_resistance": 0.6},
    "drivers": {"lost_up": 0.5, "lost_down": 0.2},
}
WEAR["rigid, all"] = RIGID | {key: value for one in WEAR.values() for key, value in one.items()}


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
    plants[1::2, columns("lost_up")] = 0.3
    plants[1::2, column("supply_resistance")] = 0.3
    beside = experiment.run(None, plants, every=5)
    assert (beside.duties[1] != alone.duties[1]).any()
    np.testing.assert_array_equal(beside.angles[::2], alone.angles[::2])
    np.testing.assert_array_equal(beside.duties[::2], alone.duties[::2])
    np.testing.assert_array_equal(beside.mse[::2], alone.mse[::2])


@pytest.mark.slow
def test_worn_arm_gets_the_same_duties_from_the_compiled_firmware() -> None:
    parameters = quiet(load_arm("worn"))
    recording = record(parameters, multi_steps([0.0, 0.5, -0.3, 0.4], [0.55, 1.5, 1.5, 1.5]), 6.0)
    require_same_duties(recording, native(recording, parameters).run_exact(every=1))
