"""The real firmware, cycle by cycle and without a wall clock: following and determinism."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.files import controller
from greywhale.files.leader import save_leader
from greywhale.files.paper_tables import paper_table
from greywhale.loop import multi_steps
from greywhale.protocol import schema
from greywhale.protocol.schema import Fault, State

RAD = schema.Sample.LSB["leader"]


def test_motors_stay_off_from_power_on_through_the_bootloader(lock_step: Any, board_name: str) -> None:
    host = lock_step(board_name, boot=False)
    on: list[int] = []
    host.bench.trace = lambda cycle, pins, angles: on.append(cycle) if pins[:5].any() else None
    assert host.board.in_bootloader
    host.boot()
    host.run(0.5)
    assert on == []


def test_the_follower_follows_and_telemetry_tells_the_truth(lock_step: Any, board_name: str) -> None:
    host = lock_step(board_name)
    host.ask(schema.TelemetryRequest(1))
    host.follow()
    host.samples.clear()
    host.run(3.5)
    leader = np.array([sample.leader for sample in host.samples]) * RAD
    follower = np.array([sample.follower for sample in host.samples]) * RAD
    ticks = np.array([sample.tick for sample in host.samples])
    assert np.all(np.diff(ticks) == 1), "a sample every tick, none lost"
    assert np.ptp(leader, axis=0) == pytest.approx([0.4] * 4, abs=0.03)
    assert np.all(np.ptp(follower, axis=0) > 0.25), "every joint moved with its leader"
    error = np.sqrt(np.mean((leader - follower) ** 2, axis=0))
    assert np.all((error > 0.001) & (error < 0.15)), error
    # What the board measured is where the arm is: 10 bits over 300 degrees is 5 mrad a step, before oversampling.
    assert follower[-1] == pytest.approx(host.bench.angles, abs=0.02)
    assert leader[-1] == pytest.approx(host.bench.leader.angles, abs=0.02)
    status = host.status()
    assert (status.late_ticks, status.rx_overruns, status.telemetry_dropped, status.no_rule) == (0, 0, 0, 0)


@pytest.mark.slow
def test_the_papers_steps_are_no_runaway(lock_step: Any, tmp_path: Path) -> None:
    save_leader(tmp_path / "steps.csv", multi_steps())
    host = lock_step(leader=tmp_path / "steps.csv")
    controllers = controller.load(paper_table("table_10")).raw_values()
    # The paper's tuned ones make a joint of this arm ring at times, longer or shorter by chance.
    set_parameters(host, controllers | {"unrest_amplitude": 0})
    host.ask(schema.TelemetryRequest(1))
    host.follow()
    host.run(multi_steps().duration_s)
    error = np.array([np.subtract(sample.leader, sample.follower) for sample in host.samples]) * RAD
    assert np.abs(error).max() > 1.0, "the steps came"
    assert np.abs(error[-200:]).max() < 0.2, "and the follower arrived"
    assert (host.status().state, host.status().fault) == (State.FOLLOWING, Fault.NONE)


def set_parameters(host: Any, changes: dict[str, int]) -> int:
    """Stage a whole set with changes made to the defaults, and apply it; its CRC."""
    values = list(schema.DEFAULTS)
    for name, raw in changes.items():
        values[schema.PARAMETER_BY_NAME[name].index] = raw
    for index, raw in enumerate(values):
        host.ask(schema.ParamSetRequest(index, raw))
    return int(host.ask(schema.ParamApplyRequest(schema.param_crc(values))).param_crc)


@pytest.mark.slow
def test_same_bytes_same_trace(lock_step: Any, board_name: str) -> None:
    def trace(kp: int, pieces: int) -> str:
        host = lock_step(board_name, boot=False)
        digest = hashlib.sha256()
        host.bench.trace = lambda cycle, pins, angles: digest.update(
            cycle.to_bytes(8, "little") + pins.tobytes() + angles.tobytes()
        )
        host.boot()
        host.ask(schema.TelemetryRequest(7))
        set_parameters(host, {"joint0.kp": kp})
        host.follow()
        for _ in range(pieces):
            host.run(1.2 / pieces)
        return digest.hexdigest()

    default = schema.PARAMETER_BY_NAME["joint0.kp"].default
    first = trace(default, 1)
    assert trace(default, 40) == first, "nor does it matter in how many pieces time is simulated"
    assert trace(default + 1000, 1) != first, "the trace shows what the controller does"
