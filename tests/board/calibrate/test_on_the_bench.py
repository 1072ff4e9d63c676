"""A whole calibration on the bench: potentiometers mounted anyhow, hands that do what is asked."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from greywhale.board.device import Device
from greywhale.board.stream import stream
from greywhale.board.upload import read_parameters, upload_set
from greywhale.cli.entry import run
from greywhale.cli.story import RunningBench
from greywhale.files.arm import default_arm
from greywhale.protocol.firmware import ANGLE_LSB
from tools.docs.schemas import schemas
from tools.support.hands import SECOND_DEG, Hands, bench_of, mounted_anyhow, run_calibrate

pytestmark = pytest.mark.slow
SECOND = ("--second", ",".join(f"{angle:g}" for angle in SECOND_DEG))
POSE = np.array([-30.0, 20.0, 35.0, -25.0])
HALF = 32  # raw, of a ratio


@pytest.fixture
def benches() -> Iterator[ExitStack]:
    with ExitStack() as started:
        yield started


def shown(bench: RunningBench, degrees: np.ndarray) -> np.ndarray:
    """The eight angles (rad) that the board reads while both arms are held there."""
    Hands(bench).bring("both", degrees, 0.2)
    with Device(bench.port, restart=False) as device:
        received = stream(device, 1)
        samples = [next(received).sample for _ in range(600)][-300:]
        device.telemetry(0)
    angles: np.ndarray = np.mean([(*one.leader, *one.follower) for one in samples], axis=0) * ANGLE_LSB
    return angles


def test_arms_mounted_anyhow_show_true_angles_after_two_known_poses(benches: ExitStack, tmp_path: Path) -> None:
    """A motor that turns the wrong way is turned round, joints that were not in use are again, and a ratio stays."""
    bench = benches.enter_context(bench_of(mounted_anyhow(1), tmp_path))
    with Device(bench.port) as device:
        idle = {f"{side}{joint}.scale": 0 for side in ("leader", "follower") for joint in (1, 3)}
        upload_set(device, read_parameters(device).with_raw(idle | {"joint2.ratio": HALF}))
    bench.command("motor 1 reversed")
    done = run_calibrate(Hands(bench), tmp_path, *SECOND)
    assert done.code == 0, done.said
    assert not bench.command("status")["motors_enabled"]
    assert shown(bench, POSE) == pytest.approx(np.tile(np.radians(POSE), 2), abs=0.004)
    facts = json.loads(done.printed)
    Draft202012Validator(schemas()["calibrate"]).validate(facts)
    assert np.degrees(facts["limits_rad"]) == pytest.approx(np.tile((-68.3, 73.3), (4, 1)), abs=0.6)
    assert [motor["sign"] for motor in facts["motors"]] == [1, -1, 1, 1]
    with Device(bench.port) as device:
        table = read_parameters(device)
    assert table.each("joint", "motor_sign")[1] == -1
    assert table["joint2.ratio"] == HALF


def test_without_a_protractor_the_two_arms_agree(benches: ExitStack, tmp_path: Path) -> None:
    bench = benches.enter_context(bench_of(mounted_anyhow(3), tmp_path))
    done = run_calibrate(Hands(bench), tmp_path, "--no-motors", "--joints", "1,3")
    assert done.code == 0, done.said
    angles = shown(bench, POSE)
    assert angles[[5, 7]] == pytest.approx(angles[[1, 3]], abs=0.004)
    assert np.abs(angles[[1, 3]]).min() > 0.2, "both have moved"


@pytest.mark.parametrize(("degrees", "passes"), [(4.0, True), (12.0, False)])
def test_the_third_pose_shows_how_far_the_arms_are_really_apart(
    benches: ExitStack, tmp_path: Path, degrees: float, passes: bool
) -> None:
    bench = benches.enter_context(bench_of(mounted_anyhow(5), tmp_path))
    done = run_calibrate(Hands(bench, apart=degrees), tmp_path, *SECOND, "--no-motors", "--joints", "1")
    assert (done.code == 0) == passes, done.said
    if passes:
        apart = json.loads(done.printed)["apart_rad"]
        assert apart == pytest.approx([0.0, np.radians(degrees), 0.0, 0.0], abs=0.004)
    else:
        assert "leader and follower differ by 0.21 rad at joint 1" in done.said


def test_an_arm_of_two_joints_is_asked_for_two_joints_and_the_others_are_not_in_use(
    benches: ExitStack, tmp_path: Path
) -> None:
    """Their inputs are open all the time. Undone, the board counts on four joints again."""
    fixed = [one.model_copy(update={"fixed": joint > 1}) for joint, one in enumerate(default_arm().joint)]
    arm = mounted_anyhow(6).model_copy(update={"joint": tuple(fixed)})
    bench = benches.enter_context(bench_of(arm, tmp_path))
    with Device(bench.port) as device:
        before = read_parameters(device)
    done = run_calibrate(Hands(bench), tmp_path, *SECOND, "--joints", "0,1", "--backup", f"{tmp_path}/mine.toml")
    assert done.code == 0, done.said
    assert done.said.count("Sweep ") == 4
    assert "joint 2" not in done.said
    facts = json.loads(done.printed)
    assert facts["joints"] == [0, 1]
    assert [motor["joint"] for motor in facts["motors"]] == [0, 1]
    assert not any(name.startswith(("joint2", "joint3")) for name in facts["changed"])
    assert shown(bench, POSE) == pytest.approx(np.tile(np.radians(POSE) * (1, 1, 0, 0), 2), abs=0.004)
    with Device(bench.port) as device:
        table = read_parameters(device)
    assert table.joints_in_use == (0, 1)
    assert table.each("leader", "scale")[2:] == (0, 0)
    assert run(["params", "restore", f"{tmp_path}/mine.toml", "--port", bench.port]) == 0
    with Device(bench.port) as device:
        assert replace(read_parameters(device), name=before.name) == before


def test_an_input_that_ends_changes_nothing(
    benches: ExitStack, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    bench = benches.enter_context(bench_of(default_arm(), tmp_path))
    with Path("/dev/null").open() as nothing:
        monkeypatch.setattr(sys, "stdin", nothing)
        assert run(["calibrate", "--port", bench.port]) == 1
    assert "the input ended in the middle of the calibration. Nothing was stored." in capsys.readouterr().err
