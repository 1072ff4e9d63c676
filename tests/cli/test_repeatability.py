"""`greywhale evaluate --repeatability`: the same figures for people, for programs and in a picture."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.telling import LINE_COLUMNS
from greywhale.cli import entry
from greywhale.files.log import LogWriter
from greywhale.files.log.layout import Origin
from greywhale.loop.leader_motions import poses

EVERY_S = 0.01


def write_visits(path: Path, lost_motion: float, sag: float) -> None:
    """Two rounds of visits; each joint stops short by half the lost motion, and joint 1 sinks."""
    motion = poses(np.full(4, -0.5), np.full(4, 0.5), 2)
    times = np.arange(0.0, motion.duration_s, EVERY_S)
    leader = motion.at(times)
    follower = leader.copy()
    for row in range(1, len(follower)):  # play drags behind
        follower[row] = np.clip(follower[row - 1], leader[row] - lost_motion / 2.0, leader[row] + lost_motion / 2.0)
    follower[:, 1] -= sag
    with LogWriter(path, Origin(param_crc=1, period_ms=1, every_ticks=10)) as log:
        for time_s, led, followed in zip(times.tolist(), leader.tolist(), follower.tolist(), strict=True):
            log.append(time_s, led, followed, [12.0 * (led[0] - followed[0])] * 4, "following")


@pytest.fixture
def logs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    monkeypatch.chdir(tmp_path)
    write_visits(Path("plain.csv"), 0.012, 0.0)
    write_visits(Path("loaded.csv"), 0.012, 0.004)
    return ["plain.csv", "loaded.csv"]


def test_it_tells_people_the_lost_motion_that_was_put_in_and_the_load(
    logs: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert entry.run(["evaluate", "--repeatability", *logs, "--arm", "worn", "--picture", "visits.svg"]) == 0
    said = capsys.readouterr().out
    plain, loaded = (
        [one.split() for one in said.splitlines() if one.startswith(f"joint {joint}, ")] for joint in (0, 1)
    )
    assert [one[-1] for one in plain] == ["12.00", "0.00"]  # vAP of the first log; beside it, nothing moved
    assert [one[-1] for one in loaded] == ["12.00", "4.00"]
    assert "see no play between themselves and the joints" in said
    assert "hides this much between both sides: joint 0 12.00 mrad" in said, "the arm file knows of some"
    rows = [line for line in said.splitlines() if line.startswith(("joint", "tip", " "))]
    assert len(rows) == 2 * 7
    assert max(map(len, rows)) <= LINE_COLUMNS
    assert Path("visits.svg").read_text(encoding="utf-8").count("<svg") == 1


def test_it_tells_programs_the_same_in_si(logs: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert entry.run(["evaluate", "--repeatability", *logs, "--json"]) == 0
    plain, loaded = json.loads(capsys.readouterr().out)["logs"]
    assert plain["moved"] == {}
    assert loaded["moved"]["1"] == pytest.approx(4e-3, abs=1e-5)
    assert [pose["joints"]["2"]["variation"] for pose in plain["poses"]] == pytest.approx([12e-3] * 5, abs=5e-5)
    assert plain["poses"][0]["tip"] is None


def test_one_log_that_shows_no_visits_is_named(logs: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    lines = Path("plain.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    Path("short.csv").write_text("".join(lines[:700]), encoding="utf-8")
    assert entry.run(["evaluate", "--repeatability", "short.csv"]) == 1
    assert "short.csv: no joint comes to rest in one pose 2 times" in capsys.readouterr().err
