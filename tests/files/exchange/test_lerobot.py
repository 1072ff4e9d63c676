"""A LeRobot dataset holds a log's samples at the frames' times, and nothing that was not recorded.

tests/oracles/test_lerobot.py has others read it: lerobot itself, and lerobot-doctor.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from greywhale.base.errors import BadUsage, UserError
from greywhale.files.exchange.lerobot import WINDOW, write
from greywhale.files.exchange.recording import ExportOptions, JointColumns, Recording
from greywhale.files.log import LogWriter, read_log
from greywhale.files.log.layout import Origin
from greywhale.files.outputs import require_new_folder
from greywhale.protocol.joints import ALL, Joints

WAVE = ExportOptions(task="Wave")


def make_log(
    path: Path,
    rows: int = 1000,
    joints: Joints = ALL,
    every: int = 1,
    state: Callable[[int], str | None] = lambda row: "following",
    task: str | None = None,
) -> Recording:
    """A log whose angles say its tick: 1 mrad a tick for the follower, 2 for the leader, 1 mV more a joint; a state of
    None is a sample that the link lost.
    """
    used = np.isin(range(4), joints)
    with LogWriter(path, Origin("0.1.0", "mega2560", 1, 1, every, joints=joints, task=task)) as log:
        for row in range(rows):
            if (word := state(row)) is None:
                log.drop(1)
                continue
            tick = row * every
            angles = tick / 1000 * used
            volts = angles + np.arange(4) / 1000 * used
            log.append(2 + tick / 1000, (2 * angles).tolist(), angles.tolist(), volts.tolist(), word)
    return Recording(read_log(path))


def read(out: Path) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """The dataset's description and its columns."""
    files = sorted(out.glob("data/*/*.parquet"))
    columns: dict[str, list[Any]] = {}
    for file in files:
        for key, values in pq.read_table(file).to_pydict().items():
            columns.setdefault(key, []).extend(values)
    info = json.loads((out / "meta/info.json").read_text())
    return info, {key: np.array(values) for key, values in columns.items()}


@pytest.mark.parametrize(("fps", "every"), [(30, 1), (25, 1), (30, 4), (1000, 1), (250, 4)])
def test_each_frame_carries_the_last_sample_at_its_time_and_those_before(tmp_path: Path, fps: int, every: int) -> None:
    recording = make_log(tmp_path / "log.csv", 2000 // every, every=every)
    assert write([recording], tmp_path / "set", ExportOptions(fps=fps, task="Wave")) == [tmp_path / "set"]
    info, columns = read(tmp_path / "set")
    width = 1000 // (fps * every)
    first = (width - 1) * every  # the earliest tick with a whole window
    due = first + 1000 * np.arange(len(columns["index"])) / fps  # ms
    tick = np.round(1000 * columns["observation.state"][:, 0].astype(float)).astype(int)
    assert ((due - tick >= 0) & (due - tick < every)).all()
    assert 2000 - every - 1000 / fps < tick[-1] <= 2000 - every
    np.testing.assert_allclose(columns["action"], np.tile(tick[:, None] / 500, 4), atol=1e-6)
    np.testing.assert_allclose(columns["observation.state"][:, 7], tick / 1000 + 0.003, atol=1e-6)
    window = tick[:, None] + every * np.arange(1 - width, 1)
    np.testing.assert_allclose(columns[WINDOW][:, :, 0], window / 1000, atol=1e-6)
    np.testing.assert_allclose(columns["timestamp"], np.arange(len(tick)) / fps, atol=1e-6)
    assert info["features"][WINDOW]["shape"] == [width, 8]
    assert info["fps"] == fps


def test_an_episode_is_the_longest_stretch_that_follows_without_a_missing_sample(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    words = {400: None, **dict.fromkeys(range(1900, 2000), "fault")}
    recording = make_log(tmp_path / "log.csv", 2000, state=lambda row: words.get(row, "following"))
    with caplog.at_level(logging.WARNING):
        write([recording], tmp_path / "set", WAVE)
    _, columns = read(tmp_path / "set")
    window = columns[WINDOW][:, :, 0]
    assert window[0, 0] == pytest.approx(0.401)
    assert np.diff(window, axis=1) == pytest.approx(0.001, abs=1e-6)
    assert window.max() < 1.9
    assert caplog.messages == [
        f"{tmp_path}/log.csv: the episode is 2.401 to 3.899 s, the longest stretch in which the motors follow and no "
        "sample is missing (1 sample lost by the link); 500 rows beside it are left out."
    ]


@pytest.mark.parametrize("joints", [(0, 2), (1,)])
def test_only_joints_in_use_and_what_was_computed_are_in_it(tmp_path: Path, joints: Joints) -> None:
    recording = make_log(tmp_path / "log.csv", joints=joints)
    torque = JointColumns("external_torque", "N m", recording.log.voltage / 4)
    write([Recording(recording.log, (torque,))], tmp_path / "set", WAVE)
    info, columns = read(tmp_path / "set")
    names = [["yaw", "shoulder", "wrist_pitch", "wrist_roll"][joint] for joint in joints]
    assert info["features"]["action"]["names"] == [f"{name}.pos" for name in names]
    assert info["features"]["observation.state"]["names"] == [
        f"{name}.{of}" for of in ("pos", "voltage", "external_torque") for name in names
    ]
    assert columns["action"].shape[1:] == (() if len(joints) == 1 else (len(joints),))  # lerobot has one as a scalar
    assert columns["observation.state"].shape[1] == 3 * len(joints)


def test_episodes_fill_files_by_size_and_are_found_by_their_table(tmp_path: Path) -> None:
    recordings = [make_log(tmp_path / f"{number}.csv", 600 + 200 * number) for number in range(3)]
    write(recordings, tmp_path / "set", WAVE, most_mb=0.001)
    assert len(list(tmp_path.glob("set/data/chunk-000/*.parquet"))) == 3
    info, columns = read(tmp_path / "set")
    np.testing.assert_array_equal(columns["index"], np.arange(info["total_frames"]))
    for row in pq.read_table(tmp_path / "set/meta/episodes/chunk-000/file-000.parquet").to_pylist():
        number = row["episode_index"]
        rows = pq.read_table(tmp_path / f"set/data/chunk-000/file-{row['data/file_index']:03d}.parquet").to_pydict()
        assert rows["episode_index"] == [number] * row["length"]
        assert rows["index"] == list(range(row["dataset_from_index"], row["dataset_to_index"]))


@pytest.mark.parametrize(
    ("asked", "tasks", "indices"),
    [(None, ["Wave", 'Say "hé"'], {0: 0, 1: 1, 2: 0}), ("Rest", ["Rest"], {0: 0, 1: 0, 2: 0})],
)
def test_the_task_is_the_logs_own_unless_another_is_asked_for(
    tmp_path: Path, asked: str | None, tasks: list[str], indices: dict[int, int]
) -> None:
    own = ["Wave", 'Say "hé"', "Wave"]
    recordings = [make_log(tmp_path / f"{number}.csv", 200, task=task) for number, task in enumerate(own)]
    write(recordings, tmp_path / "set", ExportOptions(task=asked))
    table = pq.read_table(tmp_path / "set/meta/tasks.parquet").to_pydict()
    assert table == {"task_index": list(range(len(tasks))), "task": tasks}
    _, columns = read(tmp_path / "set")
    pairs = zip(columns["episode_index"].tolist(), columns["task_index"].tolist(), strict=True)
    assert dict(pairs) == indices


@pytest.mark.parametrize(
    ("second", "options", "sentence"),
    [
        ({}, ExportOptions(), "names no task"),
        ({}, WAVE, ""),
        ({"state": lambda row: "disabled"}, WAVE, "the motors do not follow in it"),
        ({"rows": 40}, WAVE, "0.04 s long, too short for 2 frames"),
        ({"joints": (0, 1)}, WAVE, "joints 0 and 1"),
        ({"every": 4}, WAVE, "a sample every 4 ms, but"),
        (
            {"every": 40, "rows": 90},
            WAVE,
            "25 samples a second, fewer than the 30 frames asked for; give --fps 25 or less",
        ),
    ],
)
def test_a_dataset_is_whole_or_not_there(
    tmp_path: Path, second: dict[str, Any], options: ExportOptions, sentence: str
) -> None:
    out = tmp_path / "set"
    first = make_log(tmp_path / "first.csv")
    write([first], out, WAVE)
    before = read(out)[0]
    logs = [first, make_log(tmp_path / "second.csv", **second)]
    if sentence:
        with pytest.raises(UserError, match=sentence):
            write(logs, out, options)
        assert read(out)[0] == before
    else:
        write(logs, out, options)
        assert read(out)[0]["total_episodes"] == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["first.csv", "second.csv", "set"]


def test_only_a_dataset_is_written_over(tmp_path: Path) -> None:
    out = tmp_path / "set"
    require_new_folder(False, out, "data", "meta")
    write([make_log(tmp_path / "log.csv")], out, WAVE)
    require_new_folder(True, out, "data", "meta")
    with pytest.raises(BadUsage, match="exists already"):
        require_new_folder(False, out, "data", "meta")
    (out / "notes.txt").write_text("mine")
    with pytest.raises(BadUsage, match="also holds notes.txt"):
        require_new_folder(True, out, "data", "meta")
