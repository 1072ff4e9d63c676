"""The remedy of a doubt helps: who follows it has no doubt any more."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.files.trajectory import Trajectory
from greywhale.identify import IdentificationResult, identify
from greywhale.loop import human_reaches
from greywhale.measure.swings_in_logs import FIT_IT
from greywhale.tune.model import load_model
from tests.identify.conftest import alone
from tests.support.arms import make_arm
from tools.support.recordings import record, table_of

ROLL = 3


@pytest.mark.slow
def test_a_log_that_is_fitted_too_takes_the_doubt_about_it_away(white_box: ArmParameters, tmp_path: Path) -> None:
    """A log that turns one way may leave open if play or load friction held the roll back; another one shows it."""
    friction = {"coulomb": 0.05, "breakaway": 0.05}
    loose = make_arm(white_box, follower_pots={"joint": {"noise": 0.002, "play": 0.02}}, joint_3={"friction": friction})
    tables = [table_of("before_tuning"), table_of("table_10")]
    for begin in range(30, 150, 10):  # not every motion leaves it open: the first that does
        motions = [alone(human_reaches(begin + number, 8.0), (ROLL,)) for number in range(4)]
        first, second, changed, other = (
            record(loose, motion, tmp_path / f"{number}.csv", tables[number // 2])
            for number, motion in enumerate([_one_way(motions[0]), *motions[1:]])
        )
        doubtful = identify([first], white_box, validate=[second, changed], tables=tables)
        doubts = [one for one in doubtful.doubts if "joint 3 (wrist roll) follows otherwise than the model" in one]
        if doubts and any("worse than the arm file" in one for one in doubts_read(doubtful, tmp_path)):
            break
    else:
        pytest.fail("no motion leaves it open")
    assert doubts[0].endswith(f"{FIT_IT}.")
    mended = identify([first, changed], white_box, validate=[second, other], tables=tables)
    assert mended.doubts == ()
    left = doubts_read(mended, tmp_path)
    assert not any("worse than the arm file" in one or "otherwise than the model" in one for one in left)


def _one_way(motion: Trajectory) -> Trajectory:
    """The motion with all its ways back turned forward, made as large as a joint turns."""
    ways = np.cumsum(np.abs(np.diff(motion.angles, axis=0, prepend=motion.angles[:1])), axis=0)
    return replace(motion, angles=1.2 / ways.max() * ways)


def doubts_read(outcome: IdentificationResult, folder: Path) -> tuple[str, ...]:
    """The doubts that a tuning reads in the model's file."""
    outcome.save(folder / "model.toml")
    return load_model(folder / "model.toml", force=True).doubts
