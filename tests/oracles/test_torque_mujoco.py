"""Pushes on an arm of another engine are found by a model that was identified from its logs. It has play at its
potentiometers, and motors that stand apart from their joints.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.files.arm import load_arm
from greywhale.loop import human_reaches
from greywhale.observe import estimate_external_torque
from tools.support.foreign_arm import MuJoCoPlant, foreign_arm_with
from tools.support.pushed_arm import Judged, judge, record_pushed, some_pushes
from tools.support.recordings import table_of

MODEL = Path(__file__).parent / "two_masses_model.toml"  # as `greywhale identify` found this arm in a log of 25 s
SECONDS = 11.5


@pytest.fixture(scope="module")
def judged(tmp_path_factory: pytest.TempPathFactory) -> Judged:
    arm, motion = foreign_arm_with(5, ("two-masses",)), human_reaches(77, SECONDS)
    pushes = some_pushes(arm.parameters, SECONDS, (0.25, 0.5), 3)
    plant = MuJoCoPlant(arm)
    plant.reset(motion.angles[0])
    path = tmp_path_factory.mktemp("pushed") / "log.csv"
    log = record_pushed(plant, arm.parameters, motion, path, table_of("before_tuning"), pushes, 6)
    return judge(estimate_external_torque(log, load_arm(str(MODEL))), log, arm.parameters, pushes)


def test_every_push_is_seen_and_all_but_one_within_50_ms(judged: Judged) -> None:
    assert len(judged.seen) >= 6
    assert np.isfinite(judged.seen).all()
    assert np.count_nonzero(judged.seen <= 0.05) >= len(judged.seen) - 1
    assert judged.false == ()


def test_its_size_is_within_a_tenth_of_the_stall_torque_but_at_roll(judged: Judged) -> None:
    """Of roll's light link motion shows volts alone: only that something pushes it is known."""
    assert min(len(one) for one in judged.error[:3]) > 100
    assert [float(np.sqrt(np.mean(one**2))) for one in judged.error[:3]] == pytest.approx([0.0] * 3, abs=0.1)
    assert [float(np.mean(one)) > 0.9 for one in judged.held[1:3]] == [True, True]
