"""Duties that act some ticks late: the same duties, that much later, in both kernels."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm.plants import column
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
