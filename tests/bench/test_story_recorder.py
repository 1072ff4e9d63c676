"""The story's recorder: a joint that hunts ends its recording, and the next one can begin."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.board.device import Device
from greywhale.board.upload import upload_set
from greywhale.cli.story.recorder import StoppedError, record_motion
from greywhale.files.leader import save_leader
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.table import ParameterTable
from greywhale_sim.words import lock_step

HUNTS = {"joint0.kp": 64 * 65536, "joint0.kd": 0}


@pytest.mark.slow
def test_a_joint_that_hunts_ends_its_recording_and_the_next_begins(tmp_path: Path) -> None:
    leader = tmp_path / "leader.csv"
    save_leader(leader, Trajectory(np.array([0.0, 0.2]), np.zeros((2, 4))))
    with lock_step() as bench:
        with Device(bench.port) as device:
            upload_set(device, ParameterTable.defaults().with_raw(HUNTS))
        with pytest.raises(StoppedError, match="swung to and fro"):
            record_motion(bench, leader, tmp_path / "log.csv")
        with Device(bench.port) as device:
            upload_set(device, ParameterTable.defaults())
        assert record_motion(bench, leader, tmp_path / "again.csv").dropped == 0
