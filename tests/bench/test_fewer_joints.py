"""Joints that are not in use: no motor, no potentiometers, and hands that leave them alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from greywhale.board.device import Device
from greywhale.board.upload import read_parameters
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.table import ParameterTable
from greywhale_sim import faults, serve
from greywhale_sim.assemble import BenchOptions, build_bench
from greywhale_sim.bench import SLICE_S, Bench
from greywhale_sim.leader_player import LeaderPlayer
from greywhale_sim.lockstep import LockStepBench, tell_joints
from greywhale_sim.wiring import MEGA
from tests.bench.conftest import POTS, FakeBoard, FakePlant

UNUSED = {f"{side}{joint}.scale": 0 for side in ("leader", "follower") for joint in (2, 3)}


@pytest.fixture
def two(board: FakeBoard, plant: FakePlant, motion: Trajectory) -> Bench:
    leader = LeaderPlayer(motion, SLICE_S, joints=(0, 1))
    return Bench(board, MEGA, plant, leader, POTS, 15.0, joints=(0, 1))


def test_their_inputs_float_and_their_motors_are_off_whatever_is_injected_and_mended(two: Bench) -> None:
    assert two.floating == 0b1100_1100
    faults.inject(two, "motor-reversed:2")
    faults.inject(two, "motor-swapped:1")
    two.let_float(3, False)
    assert two.floating == 0b1100_1100
    assert two.motor_gains[2:] == [0.0, 0.0]
    two.mend()
    assert two.motor_gains == [1.0, 1.0, 0.0, 0.0]
    assert two.floating == 0b1100_1100


def test_hands_and_motions_leave_them_at_0(two: Bench) -> None:
    two.leader.bring(np.full(4, 0.5), np.full(4, 0.4), 0.01)
    for _ in range(100):
        two.leader.step(False, np.zeros(4))
    np.testing.assert_array_equal(two.leader.angles, [0.5, 0.5, 0.0, 0.0])
    np.testing.assert_array_equal(two.leader.hold, [0.4, 0.4, 0.0, 0.0])


def test_a_board_that_was_told_knows_the_joints_of_its_arm_after_a_reset() -> None:
    options = BenchOptions(arm=Path("two_joints"))
    bench = build_bench(options)
    assert bench.floating == 0b1100_1100
    tell_joints(bench, options)
    cast(Any, bench.board).reset()
    with LockStepBench(options, bench) as served, Device(served.port) as device:
        assert read_parameters(device) == ParameterTable.defaults().with_raw(UNUSED)


@pytest.mark.parametrize(("options", "told"), [({}, True), ({"blank": True}, False), ({"eeprom": "kept"}, False)])
def test_only_a_new_board_is_told_its_joints(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: dict[str, object], told: bool
) -> None:
    """A board that somebody set up, or whose firmware is not there yet, is left as it is."""
    eeprom = tmp_path / "eeprom.bin"
    if "eeprom" in options:
        eeprom.write_bytes(b"\xff" * 4096)
    asked: list[Bench] = []
    monkeypatch.setattr(serve, "tell_joints", lambda bench, options: asked.append(bench))
    given = {**options, "eeprom": eeprom} if "eeprom" in options else options
    with serve.running(serve.ServeOptions(arm=Path("two_joints"), **given)) as server:  # type: ignore[arg-type]
        assert asked == [server.bench] * told
