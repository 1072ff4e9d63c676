"""What is simulated natively is what the compiled firmware does on the bench: the same duties, the same errors."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.files.arm import default_arm
from greywhale.motion import human_reaches, multi_steps
from greywhale.protocol.schema import Board
from greywhale.protocol.table import ParameterTable
from greywhale.simulate import Experiment, Result
from tests.simulate.on_the_bench import Recording, quiet, record

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
