"""A verb that is killed half-way leaves no half result, no set that nobody asked for, and motors that go off."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from greywhale.arm.export import urdf
from greywhale.cli import entry
from greywhale.files.arm import load_arm
from greywhale.files.leader import save_leader
from greywhale.files.log import read_log
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.schema import State
from tests.board.port_board import PortBoard
from tests.support.killing import count_changes, kill

LEASE_TICKS = 600  # the lease, and what was on its way
MOVING = (State.SOFT_START, State.FOLLOWING)
ON_A_BOARD = {
    "record -s 0.4 --enable -o log.csv": "log.csv",
    "record -s 0.4 --reconnect -o log.csv": "log.csv",
    "replay motion.csv --yes -o log.csv": "log.csv",
    "upload table_8": "",
    "params set joint0.kp=0.5 supply_mv=12000": "",
    "params backup backup.toml": "backup.toml",
    "stop --clear-fault": "",
}
ALONE = {
    "arm import arm.urdf -o arm.toml": ("arm.toml",),
    "export --fis table_8 --out c.fis": tuple(f"c_joint{joint}.fis" for joint in range(4)),
    "compare --functions sphere --methods gwo --budget 30 --seeds 1 --jobs 1 -o c.csv": ("c.csv",),
}


@pytest.fixture(autouse=True)
def _quick_boards_and_inputs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    times = np.arange(0.0, 0.3, 0.05)
    save_leader(tmp_path / "motion.csv", Trajectory(times, 0.02 * np.sin(9.0 * times)[:, None] * np.ones(4)))
    (tmp_path / "arm.urdf").write_text(urdf(load_arm("default")), encoding="utf-8")


def run(verb: str, folder: Path, port: str = "") -> None:
    """The verb in a folder of its own, with the inputs beside it."""
    folder.mkdir(exist_ok=True)
    for name in ("motion.csv", "arm.urdf"):
        if not (folder / name).exists():
            os.link(name, folder / name)
    os.chdir(folder)
    assert entry.run([*verb.split(), *(["--port", port] if port else [])]) == 0


@pytest.mark.parametrize("verb", ON_A_BOARD)
def test_a_board_is_off_and_keeps_a_whole_set(tmp_path: Path, verb: str) -> None:
    result = ON_A_BOARD[verb]
    with PortBoard() as whole:
        before = list(whole.stored)
        changes = count_changes(lambda: run(verb, tmp_path / "whole", whole.port))
        sets = [before, list(whole.stored)]
    with PortBoard() as board:
        kill(lambda: run(verb, tmp_path / "killed", board.port), changes // 2)
        board.hurry()
        wait_for_rest(board)
        assert board.running in sets
        assert board.stored in sets
    path = tmp_path / "killed" / result
    if result.endswith(".csv"):
        assert not path.exists()
        assert all(not read_log(log).complete for log in path.parent.glob("log.unfinished*"))
    elif result:
        assert not path.exists() or path.read_bytes() == (tmp_path / "whole" / result).read_bytes()


def wait_for_rest(board: PortBoard) -> None:
    """Until the motors are off, by the lease at the latest."""
    died = board.tick
    while board.problem is None and board.state in MOVING and board.tick < died + LEASE_TICKS:
        os.sched_yield()
    assert board.state not in MOVING, f"the motors are on after {board.tick - died} ticks (lease {board.lease_ms} ms)"


@pytest.mark.parametrize("verb", ALONE)
def test_a_result_is_absent_or_whole(tmp_path: Path, verb: str) -> None:
    changes = count_changes(lambda: run(verb, tmp_path / "whole"))
    kill(lambda: run(verb, tmp_path / "killed"), changes // 2)
    for name in ALONE[verb]:
        path = tmp_path / "killed" / name
        assert not path.exists() or path.read_bytes() == (tmp_path / "whole" / name).read_bytes()
