"""An arm with two joints on a Nano, from the box to a following arm, by the verbs that a person uses, on the bench.

The Nano's last two motors have 255 PWM steps where a Mega has 400: it is excited, identified and tuned as what it is.
"""

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
from greywhale.files.leader import save_leader
from greywhale.files.log import read_log
from greywhale.files.model import arm_toml
from greywhale.loop import human_reaches
from greywhale.loop.closed_loop import ClosedLoop, Result
from greywhale.protocol.schema import Board
from greywhale.tune.model import load_model
from tests.support.arms import with_joints
from tests.support.tuning import few_orders, judge_nothing, shorten
from tools.support.calibrating_person import SECOND_DEG, CalibratingPerson, bench_of, mounted_anyhow, run_calibrate

JOINTS, IDLE = [0, 2], [1, 3]
FULL = 255  # PWM steps of joint 2
SECOND = ",".join(f"{angle:g}" for angle in SECOND_DEG)


def ask(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    """The JSON of a verb, which must succeed."""
    capsys.readouterr()
    code = run([*words, "--json"])
    told = capsys.readouterr()
    assert code == 0, told.err
    found: dict[str, Any] = json.loads(told.out)
    return found


def full_duties_of_every_loop(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The largest duty of every joint in all closed loops to come, in PWM steps; they keep no traces otherwise."""
    largest = [0, 0, 0, 0]
    simulate = ClosedLoop.run

    def watched(self: ClosedLoop, controllers: Any, plants: Any, **options: Any) -> Result:
        result = simulate(self, controllers, plants, **options | {"every": options.get("every") or 50})
        if result.duties.size:
            seen = np.abs(result.duties.astype(int)).max(axis=(0, 1))
            largest[:] = [max(one, int(other)) for one, other in zip(largest, seen, strict=True)]
        return result

    monkeypatch.setattr(ClosedLoop, "run", watched)
    return largest


@pytest.mark.slow
def test_two_joints_on_a_nano_from_the_box_to_a_following_arm(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    shorten(monkeypatch)
    judge_nothing(monkeypatch)
    few_orders(monkeypatch)
    largest = full_duties_of_every_loop(monkeypatch)
    (tmp_path / "white.toml").write_text(arm_toml(with_joints((0, 2), "white_box"), "Two joints."))
    save_leader(tmp_path / "motion.csv", human_reaches(1, 5.0))
    options = ("--board", "nano", "--leader", str(tmp_path / "motion.csv"))
    with bench_of(with_joints((0, 2), mounted_anyhow(11)), tmp_path, *options) as bench:
        port = ("--port", bench.port)
        done = run_calibrate(CalibratingPerson(bench), tmp_path, "--joints", "0,2", "--second", SECOND)
        assert done.code == 0, done.said
        ask(capsys, "arm", "match", "white.toml", *port, "--out", "mine.toml")
        ask(capsys, "params", "backup", "board.toml", *port)
        excite = ("--arm", "mine.toml", "--seconds", "6", "--budget", "4", "-o", "fit.csv")
        ask(capsys, "record", "--excite", *excite, *port)
        capsys.readouterr()
        assert run(["record", "--excite", "--arm", "default", "-o", "no.csv", *port]) == 1
        assert "the arm file uses all four joints, but the board uses joints 0 and 2." in capsys.readouterr().err
        ask(capsys, "record", "--enable", "--seconds", "5", "-o", "before.csv", *port)
        ask(capsys, "replay", "motion.csv", "-o", "replayed.csv", *port)
        told = ask(
            capsys, "identify", "fit.csv", "--validate", "before.csv", "--arm", "mine.toml", "--controller",
            "board.toml", "-o", "model.toml",
        )  # fmt: skip
        assert {one["name"].partition(".")[0] for one in told["parameter"]} <= {"joint0", "joint2", "arm"}
        assert told["board"] == "nano328"
        assert told["log"][1]["improvement"] > 0.8, "a short search on a short log"
        assert not any("joint 1" in sentence or "joint 3" in sentence for sentence in told["not_identified"])
        assert load_model(Path("model.toml")).table.board is Board.NANO328
        told = ask(
            capsys, "tune", "model.toml", "--budget", "150", "--samples", "2", "--arm", "mine.toml", "-o",
            "controller.toml",
        )  # fmt: skip
        assert 'board = "nano328"' in Path("controller.toml").read_text()
        doubts = ask(capsys, "upload", "controller.toml", *port)["warnings"]
        # So short a search may leave a margin open; nothing else may be wrong, such as the board or its period.
        assert [one for one in doubts if not one.startswith("a joint may swing")] == []
        ask(capsys, "record", "--enable", "--seconds", "5", "-o", "after.csv", *port)
        with Device(bench.port) as device:
            table = read_parameters(device)
        assert table.joints_in_use == (0, 2)
        changed = {name.partition(".")[0] for name in ask(capsys, "params", "diff", "board.toml", *port)["differences"]}
        assert {"joint0", "joint2"} <= changed
        assert not changed & {"joint1", "joint3", "leader0", "follower0", "leader1", "follower3"}
        before, after = ask(capsys, "evaluate", "before.csv", "after.csv", "--picture", "both.png")["logs"]
        assert [joint["in_use"] for joint in after["joints"]] == [True, False, True, False]
        assert after["total_mse_rad2"] < before["total_mse_rad2"]
        assert all(joint["follows"] for joint in after["joints"])
        assert run(["evaluate", "after.csv"]) == 0
        text = capsys.readouterr().out
        assert "Joints 1 and 3 are not in use." in text
        assert "\njoint 1" not in text
    for name in ("fit.csv", "before.csv", "replayed.csv", "after.csv"):
        log = read_log(name)
        assert log.joints_in_use == (0, 2)
        assert log.origin.board == "nano328"
        for columns in (log.leader, log.follower, log.voltage):
            np.testing.assert_array_equal(columns[:, IDLE], 0.0)
        assert np.ptp(log.follower, axis=0)[JOINTS].min() > 0.2
    assert largest[2] == FULL, "excitation, identification and tuning simulated other timers than the board's"
    capsys.readouterr()
    assert run(["identify", "fit.csv", "--validate", "before.csv", "--arm", "white_box", "-o", "no.toml"]) == 1
    assert "the arm file uses all four joints, but fit.csv uses joints 0 and 2." in capsys.readouterr().err
    assert run(["tune", "model.toml", "--method", "paper", "-o", "no.toml"]) == BAD_USAGE
