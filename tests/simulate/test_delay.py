"""Duties that act some ticks late: the same duties, that much later, in both kernels."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm.plants import column
from greywhale.base.errors import UserError
from greywhale.files.arm import default_arm
from greywhale.motion import human_reaches
from greywhale.simulate import Experiment, Timing, plant_row
from tests.simulate.on_the_bench import quiet

LATE = 7


def stuck() -> np.ndarray:
    """A follower that nothing moves, so that the duties follow from the leader alone."""
    plant = plant_row(default_arm())
    for joint in range(4):
        for name in ("coulomb", "breakaway"):
            plant[column(name, joint)] = 1e6
    return plant


@pytest.mark.parametrize("run", ["run", "run_exact"])
def test_late_duties_are_the_prompt_ones_shifted(run: str) -> None:
    motion, arm = human_reaches(3, 4.0), quiet(default_arm())
    traces = {}
    for late in (0, LATE):
        experiment = Experiment(motion, arm, timing=Timing(late=late), noise=False)
        traces[late] = getattr(experiment, run)(None, stuck(), every=1).duties[0]
    assert len(np.unique(traces[0])) > 50, "the motors were hardly driven, so little is compared"
    np.testing.assert_array_equal(traces[LATE][LATE:], traces[0][:-LATE])
    assert (traces[LATE][:LATE] == 0).all()


def test_both_kernels_move_the_arm_alike_under_late_duties() -> None:
    experiment = Experiment(human_reaches(4, 4.0), default_arm(), noise=False, timing=Timing(late=3))
    batch, exact = experiment.run(every=1, steps_per_tick=4), experiment.run_exact(every=1)
    moving = 2500
    assert np.abs(exact.duties[0, :moving]).max() > 40
    np.testing.assert_allclose(batch.angles[0, :moving], exact.angles[0, :moving], atol=2e-3)


def test_a_long_delay_makes_the_loop_swing() -> None:
    """The quick wrist, with 40 and 60 ms more."""
    wrist = [
        Experiment(human_reaches(4, 4.0), default_arm(), timing=Timing(late=late)).run().mse[0, 3]
        for late in (0, 40, 60)
    ]
    assert wrist[0] < wrist[1] < wrist[2]
    assert wrist[2] > 100 * wrist[0]


@pytest.mark.parametrize("late", [-1, 1001])
def test_impossible_delays_are_refused(late: int) -> None:
    with pytest.raises(UserError, match=rf"late is {late}, but it must be a number of ticks in 0..1000"):
        Timing(late=late)
