"""Volts that a driver loses in one direction more than in the other are found for what they are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.base.types import show_no_progress
from greywhale.identify.data import prepare
from greywhale.identify.search import Search
from greywhale.loop import human_reaches
from tests.identify.conftest import alone
from tests.support.arms import make_arm
from tools.support.recordings import record, table_of

LOST_UP, LOST_DOWN = 0.1, 0.4  # V


def test_they_are_no_zero_angle(white_box: ArmParameters, tmp_path: Path) -> None:
    """A shoulder that must be held up shows them as a weight that is not there."""
    shoulder = {
        "friction": {"coulomb": 0.3, "breakaway": 0.3},
        "driver": {"lost_up": LOST_UP, "lost_down": LOST_DOWN},
    }
    lossy = make_arm(white_box, follower_pots={"joint": {"noise": 0.002}}, joint_1=shoulder)
    log = record(lossy, alone(human_reaches(11, 9.0)), tmp_path / "fit.csv", table_of("before_tuning"))
    search = Search(white_box, [prepare(log, 1)], (), (1,), 0, show_no_progress)
    search.run()
    best = search.best
    assert best is not None
    assert best.order == "drivers that lose volts"
    found = dict(zip(best.space.names, best.space.values(best.x), strict=True))
    assert found["joint1.uneven"] == pytest.approx(0.5 * (LOST_UP - LOST_DOWN), abs=0.02)
    np.testing.assert_array_equal(best.zero, np.zeros(4))
