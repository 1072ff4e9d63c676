"""A whole calibration on the bench: potentiometers mounted anyhow, hands that do what is asked."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from greywhale.board.device import Device
from greywhale.board.stream import stream
from greywhale.board.upload import read_parameters, upload_set
from greywhale.cli.story import RunningBench
from greywhale.protocol.firmware import ANGLE_LSB
from tools.docs.schemas import schemas
from tools.support.calibrating_person import SECOND_DEG, bench_of, mounted_anyhow, quick_person, run_calibrate

pytestmark = pytest.mark.slow
SECOND = ("--second", ",".join(f"{angle:g}" for angle in SECOND_DEG))
POSE = np.array([-30.0, 20.0, 35.0, -25.0])
HALF = 32  # raw, of a ratio


def shown(bench: RunningBench, degrees: np.ndarray) -> np.ndarray:
    """The eight angles (rad) that the board reads while both arms are held there."""
    quick_person(bench).bring("both", degrees, 0.2)
    with Device(bench.port, restart=False) as device:
        received = stream(device, 1)
        samples = [next(received).sample for _ in range(600)][-300:]
        device.telemetry(0)
    angles: np.ndarray = np.mean([(*one.leader, *one.follower) for one in samples], axis=0) * ANGLE_LSB
    return angles


def test_arms_mounted_anyhow_show_true_angles_after_two_known_poses(tmp_path: Path) -> None:
    """A motor that turns the wrong way is turned round, joints that were not in use are again, and a ratio stays."""
    with bench_of(mounted_anyhow(1), tmp_path) as bench:
        with Device(bench.port) as device:
            idle = {f"{side}{joint}.scale": 0 for side in ("leader", "follower") for joint in (1, 3)}
            upload_set(device, read_parameters(device).with_raw(idle | {"joint2.ratio": HALF}))
        bench.command("motor 1 reversed")
        done = run_calibrate(quick_person(bench), tmp_path, *SECOND)
        assert done.code == 0, done.said
        assert not bench.command("status")["motors_enabled"]
        assert shown(bench, POSE) == pytest.approx(np.tile(np.radians(POSE), 2), abs=0.004)
        with Device(bench.port) as device:
            table = read_parameters(device)
    facts = json.loads(done.printed)
    Draft202012Validator(schemas()["calibrate"]).validate(facts)
    assert np.degrees(facts["limits_rad"]) == pytest.approx(np.tile((-68.3, 73.3), (4, 1)), abs=0.6)
    assert [motor["sign"] for motor in facts["motors"]] == [1, -1, 1, 1]
    assert table.each("joint", "motor_sign")[1] == -1
    assert table["joint2.ratio"] == HALF
