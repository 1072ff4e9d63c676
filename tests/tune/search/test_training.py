"""A person's own motion in the place of the training motions."""

from __future__ import annotations

import numpy as np

from greywhale.arm.plants import plant_row
from greywhale.files.arm import default_arm
from greywhale.files.trajectory import Trajectory
from greywhale.loop import human_reaches
from greywhale.protocol.table import ParameterTable
from greywhale.tune.search.training import WAIT_S, own_motion, reach


def test_a_persons_motion_is_trained_on_within_the_range_of_the_arm() -> None:
    arm, table = default_arm(), ParameterTable.defaults()
    plants = plant_row(arm)[None]
    path = human_reaches(4, 5.0)
    wide = Trajectory(path.time_s, 3.0 * path.angles)
    made = own_motion(wide, arm, table, plants)
    low, high = reach(arm, table, plants)
    assert np.all((made.motion.angles >= low) & (made.motion.angles <= high))
    waited = round(1e3 * WAIT_S)
    np.testing.assert_allclose(made.experiment.leader[waited::5][:600], made.motion.angles[:600], atol=1e-9)
    assert made.total_weight > 0.0
    assert not made.experiment.weight_s[:waited].any()
