"""LeRobot's datasets and plug-in, by those who read and call them: lerobot itself, and lerobot-doctor.

lerobot 0.6.1 runs with stand-ins for torch, other devices and policies (`lerobot/stand_ins.py`): its base classes, its
discovery and factory of devices, `lerobot-record` and its datasets are the real ones.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.board.device import Device
from greywhale.board.record import record
from greywhale.cli.story import BenchProcess
from greywhale.files.exchange.lerobot import write
from greywhale.files.exchange.lerobot_frames import frames_of
from greywhale.files.exchange.recording import ExportOptions, Recording
from greywhale.files.leader import save_leader
from greywhale.files.log import read_log
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.joints import NAMES
from tools import ROOT
from tools.oracles import lerobot

HISTOGRAM_BINS = 1000  # of lerobot, a fifth of its own: it moves counts from bin to bin where the range grows
SIDE = Path(__file__).with_name("lerobot")
needs_lerobot = pytest.mark.skipif(lerobot.find_python() is None, reason="lerobot needs Python 3.12, which is not here")


def run_lerobot(script: str, *arguments: str | Path, home: Path) -> subprocess.CompletedProcess[str]:
    command = [lerobot.PYTHON, SIDE / "stand_ins.py", SIDE / script, *arguments]
    environment = {**os.environ, "HF_HOME": str(home), "HF_HUB_OFFLINE": "1", "PYTHONPATH": str(ROOT / "host/src")}
    return subprocess.run(command, capture_output=True, text=True, env=environment, timeout=120, check=False)


@pytest.fixture(scope="module")
def leader(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All joints wave, each at its own pace, from rest."""
    time_s = np.arange(3001) / 100
    turns = (
        0.5 * np.sin(2 * np.pi * time_s[:, None] * np.array([0.3, 0.23, 0.31, 0.4])) * np.minimum(time_s, 1)[:, None]
    )
    path = tmp_path_factory.mktemp("leader") / "leader.csv"
    save_leader(path, Trajectory(time_s, turns + np.array([0.0, 0.4, 0.0, 0.0])))
    return path


@pytest.fixture
def bench(leader: Path) -> Iterator[BenchProcess]:
    """In real time, as lerobot-record lives."""
    with BenchProcess("--speed", "1", "--leader", str(leader)) as started:
        yield started


@pytest.fixture(scope="module")
def exported(leader: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Recording]]:
    """A dataset of two logs from the bench."""
    folder = tmp_path_factory.mktemp("exported")
    with BenchProcess("--speed", "max", "--leader", str(leader)) as bench, Device(bench.port) as device:
        for number in range(2):
            record(device, folder / f"{number}.csv", 4.0, enable=True)
    logs = [Recording(read_log(folder / f"{number}.csv")) for number in range(2)]
    write(logs, folder / "set", ExportOptions(task="Wave"))
    return folder / "set", logs


def test_lerobot_doctor_finds_nothing_but_that_there_are_no_cameras(exported: tuple[Path, list[Recording]]) -> None:
    command = [
        str(Path(sys.executable).with_name("lerobot-doctor")),
        "check",
        str(exported[0]),
        "--ci",
        "--fail-on=warn",
    ]
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    report = json.loads(answer.stdout)
    assert len(report["checks"]) == 11
    found = [
        (one["name"], said["message"])
        for one in report["checks"]
        for said in one["messages"]
        if said["severity"] != "PASS"
    ]
    assert found == [("Training Readiness", "VLA (Vision-Language-Action): no image/video features")]


def quantiles_around(values: np.ndarray, begins: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray]:
    """The values two ranks to either side of a quantile, the mean of the episodes by their frames.

    lerobot takes the rank that its histogram gives; where samples lie far apart, the next one may be far off.
    """
    found = []
    for begin, end in begins:
        rows = values[begin:end].reshape(-1, values.shape[-1] if values.ndim > 1 else 1)
        around = np.clip([share - 2 / len(rows), share + 2 / len(rows)], 0.0, 1.0)
        found.append(np.quantile(rows, around, axis=0))
    low, high = np.average(found, axis=0, weights=np.diff(begins, axis=1)[:, 0])
    return low, high


@needs_lerobot
def test_lerobot_reads_the_samples_and_finds_the_same_statistics(
    exported: tuple[Path, list[Recording]], tmp_path: Path
) -> None:
    out = tmp_path / "read.npz"
    answer = run_lerobot("read_dataset.py", exported[0], out, home=tmp_path)
    assert answer.returncode == 0, answer.stderr
    read = np.load(out)
    assert set(read["tasks"]) == {"Wave"}
    assert read["names"].tolist()[3:5] == ["wrist_roll.pos", "yaw.voltage"]
    for (begin, end), log in zip(read["begins"], exported[1], strict=True):
        episode, frames = frames_of(log, 30), slice(0, end - begin)
        window = episode.windows(frames)
        for key, values in (
            ("action", episode.actions(frames)),
            ("observation.state", window[:, -1]),
            ("observation.joints_window", window),
        ):
            np.testing.assert_array_equal(read[key][begin:end], values)
    keys = [key for key in read.files if key.startswith("found/")]
    assert len(keys) == 8 * 10
    for key in keys:
        _, feature, name = key.split("/")
        found, stored = read[key], read[key.replace("found/", "stored/")]
        assert stored.shape == found.shape
        width = np.ptp(read[feature])
        if name.startswith("q"):
            low, high = quantiles_around(read[feature], read["begins"], int(name[1:]) / 100)
            bin_width = width / HISTOGRAM_BINS + 1e-9
            for one in (found, stored):
                assert (one >= low - bin_width).all(), key
                assert (one <= high + bin_width).all(), key
        else:
            np.testing.assert_allclose(stored, found, atol=1e-5 * width + 1e-9, rtol=1e-5, err_msg=key)


def motors_go_off(bench: BenchProcess, within_s: float) -> bool:
    """True if the bench's motors are off by then, in its own time."""
    begin = bench.command("status")["time_s"]
    while (status := bench.command("status"))["motors_enabled"] and status["time_s"] < begin + within_s:
        pass
    return not status["motors_enabled"]


@needs_lerobot
def test_lerobot_record_writes_what_leader_and_follower_did(bench: BenchProcess, tmp_path: Path) -> None:
    folder, out = tmp_path / "set", tmp_path / "read.npz"
    answer = run_lerobot("record.py", bench.port, folder, out, home=tmp_path)
    assert answer.returncode == 0, answer.stderr
    assert not bench.command("status")["motors_enabled"]
    read = np.load(out)
    assert len(read["begins"]) == 2
    action, state = read["action"], read["observation.state"]
    assert len(action) > 10
    assert np.ptp(action[:, 0]) > 0.2  # it waved
    assert np.median(np.abs(action - state[:, :4])) < 0.2  # and was followed; a busy computer reads some states late
    assert read["names"].tolist() == [f"{joint}.{of}" for of in ("pos", "voltage") for joint in NAMES]


@needs_lerobot
def test_actions_lead_within_limits_and_motors_go_off_with_their_process(bench: BenchProcess, tmp_path: Path) -> None:
    answer = run_lerobot("drive.py", bench.port, home=tmp_path)
    assert answer.stdout, answer.stderr
    facts: dict[str, Any] = json.loads(answer.stdout)
    assert motors_go_off(bench, 0.6)  # a lease is half a second
    time_s, path = np.array(facts["path"]).T
    assert path[-1] == pytest.approx(facts["goal"]["yaw.pos"], abs=0.05)
    assert (path - facts["start"]["yaw.pos"] < time_s + 0.15).all()  # asked for 1 rad/s at most
    assert 2.3 < facts["sent"]["yaw.pos"] < 2.7  # the joint's limit, not 9 rad
    for name, angle in facts["followed"].items():
        assert facts["observed"][name] == pytest.approx(angle, abs=0.2)
    sentences = [
        "actions lead the arm already; connect greywhale_leader before the robot",
        "the action has an angle that is no number: [nan",
        "the action has no 'shoulder.pos'; it must have yaw.pos, shoulder.pos",
        "the action is not what greywhale_leader said, but the follower follows that arm by itself; leave",
    ]
    for sentence, said in zip(sentences, facts["said"], strict=True):
        assert sentence in said
