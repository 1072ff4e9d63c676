"""An arm with two joints from the box to a following arm, by the verbs that a person uses, on the bench."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.base.errors import BAD_USAGE
from greywhale.board.device import Device
from greywhale.board.upload import read_parameters
from greywhale.cli.entry import run
from greywhale.files.arm import load_arm
from greywhale.files.leader import save_leader
from greywhale.files.log import read_log
from greywhale.files.model import arm_toml
from greywhale.motion import human_reaches
from tests.support.tuning import judge_nothing, shorten
from tools.support.hands import SECOND_DEG, Hands, bench_of, mounted_anyhow, run_calibrate

IDLE = slice(2, 4)
SECOND = ",".join(f"{angle:g}" for angle in SECOND_DEG)


def ask(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    """What a verb prints with --json; it must succeed."""
    capsys.readouterr()
    code = run([*words, "--json"])
    told = capsys.readouterr()
    assert code == 0, told.err
    found: dict[str, Any] = json.loads(told.out)
    return found


def with_two_joints(name: str, path: Path) -> None:
    arm = load_arm(name)
    joints = tuple(one.model_copy(update={"fixed": number > 1}) for number, one in enumerate(arm.joint))
    path.write_text(arm_toml(arm.model_copy(update={"joint": joints}), "Two joints."), encoding="utf-8")


@pytest.mark.slow
def test_two_joints_from_the_box_to_a_following_arm(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    shorten(monkeypatch)
    judge_nothing(monkeypatch)
    true = mounted_anyhow(11).model_copy(update={"joint": load_arm("two_joints").joint})
    with_two_joints("white_box", tmp_path / "white.toml")
    save_leader(tmp_path / "motion.csv", human_reaches(1, 6.0))
    with bench_of(true, tmp_path, "--leader", str(tmp_path / "motion.csv")) as bench:
        port = ("--port", bench.port)
        done = run_calibrate(Hands(bench), tmp_path, "--joints", "0,1", "--second", SECOND)
        assert done.code == 0, done.said
        ask(capsys, "arm", "match", "white.toml", *port, "--out", "mine.toml")
        ask(capsys, "params", "backup", "board.toml", *port)
        for seed, name in enumerate(("fit.csv", "second.csv")):
            options = ("--arm", "mine.toml", "--seconds", "6", "--budget", "4", "--seed", str(seed), "-o", name)
            ask(capsys, "record", "--excite", *options, *port)
        capsys.readouterr()
        assert run(["record", "--excite", "--arm", "default", "-o", "no.csv", *port]) == 1
        assert "the arm file uses all four joints, but the board uses joints 0 and 1." in capsys.readouterr().err
        ask(capsys, "record", "--enable", "--seconds", "6", "-o", "before.csv", *port)
        ask(capsys, "replay", "motion.csv", "-o", "replayed.csv", *port)
        told = ask(
            capsys, "identify", "fit.csv", "--validate", "second.csv", "--arm", "mine.toml", "--controller",
            "board.toml", "-o", "model.toml",
        )  # fmt: skip
        assert {one["name"].partition(".")[0] for one in told["parameter"]} <= {"joint0", "joint1", "arm"}
        assert told["log"][1]["improvement"] > 0.9
        assert not any("joint 2" in sentence or "joint 3" in sentence for sentence in told["not_identified"])
        told = ask(
            capsys, "tune", "model.toml", "--budget", "200", "--arm", "mine.toml", "-o", "controller.toml",
        )  # fmt: skip
        ask(capsys, "upload", "controller.toml", *port)
        ask(capsys, "record", "--enable", "--seconds", "6", "-o", "after.csv", *port)
        with Device(bench.port) as device:
            table = read_parameters(device)
        assert table.joints_in_use == (0, 1)
        changed = {name.partition(".")[0] for name in ask(capsys, "params", "diff", "board.toml", *port)["differences"]}
        assert {"joint0", "joint1"} <= changed
        assert not changed & {"joint2", "joint3", "leader0", "follower0", "leader2", "follower3"}
        before, after = ask(capsys, "evaluate", "before.csv", "after.csv", "--picture", "both.png")["logs"]
        assert [joint["in_use"] for joint in after["joints"]] == [True, True, False, False]
        assert after["total_mse_rad2"] < before["total_mse_rad2"]
        assert all(joint["follows"] for joint in after["joints"])
        assert run(["evaluate", "after.csv"]) == 0
        text = capsys.readouterr().out
        assert "Joints 2 and 3 are not in use." in text
        assert "\njoint 2" not in text
    for name in ("fit.csv", "second.csv", "before.csv", "replayed.csv", "after.csv"):
        log = read_log(name)
        assert log.joints_in_use == (0, 1)
        for columns in (log.leader, log.follower, log.voltage):
            np.testing.assert_array_equal(columns[:, IDLE], 0.0)
        assert np.ptp(log.follower, axis=0)[:2].min() > 0.2
    capsys.readouterr()
    assert run(["identify", "fit.csv", "--validate", "second.csv", "--arm", "white_box", "-o", "no.toml"]) == 1
    assert "the arm file uses all four joints, but fit.csv uses joints 0 and 1." in capsys.readouterr().err
    assert run(["tune", "model.toml", "--method", "paper", "-o", "no.toml"]) == BAD_USAGE
