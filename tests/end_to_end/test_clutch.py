"""Motion scaling and clutch on both boards: the arm goes where they say, and nothing jumps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greywhale.protocol import schema
from greywhale.protocol.schema import Clutch, Fault, State
from tests.end_to_end.test_lock_step import RAD, set_parameters

pytestmark = pytest.mark.slow
RATIO_ONE, THIRD, DOUBLE = 64, 21, 128  # raw
NEAR_RAD = 0.08  # the default controllers' error at rest


def scaled(host: Any, raw: int, **others: int) -> None:
    set_parameters(host, {f"joint{joint}.ratio": raw for joint in range(4)} | others)


def lead(host: Any, angles: list[float], seconds: float = 2.0) -> None:
    host.bench.leader.lead(np.array(angles))
    host.run(seconds)


def references(host: Any) -> np.ndarray:
    return np.array([sample.leader for sample in host.samples]) * RAD


def well(host: Any) -> bool:
    status = host.status()
    counters = (status.late_ticks, status.rx_overruns, status.telemetry_dropped)
    return (status.state, status.fault, counters) == (State.FOLLOWING, Fault.NONE, (0, 0, 0))


@pytest.mark.parametrize(("board", "raw"), [("mega", THIRD), ("nano", DOUBLE)])
def test_the_follower_goes_so_many_times_as_far_as_its_leader(lock_step: Any, board: str, raw: int) -> None:
    host = lock_step(board)
    lead(host, [0.0] * 4, 1.5)
    scaled(host, raw)
    host.follow()
    lead(host, [0.6, -0.5, 0.4, -0.6])
    wanted = np.array([0.6, -0.5, 0.4, -0.6]) * raw / RATIO_ONE
    assert host.bench.angles == pytest.approx(wanted, abs=NEAR_RAD)
    assert well(host)


def test_the_pedal_moves_the_leader_alone_and_nothing_jumps(lock_step: Any, board_name: str) -> None:
    host = lock_step(board_name)
    lead(host, [0.0] * 4, 1.5)
    scaled(host, DOUBLE)
    host.follow()
    lead(host, [0.3, 0.0, 0.2, 0.0])
    host.ask(schema.TelemetryRequest(1))
    host.samples.clear()
    held = host.bench.angles.copy()
    host.bench.press_clutch(True)
    lead(host, [-0.3, 0.3, -0.3, 0.2])
    assert host.status().clutch is Clutch.DISENGAGED
    assert host.bench.angles == pytest.approx(held, abs=0.01)
    host.bench.press_clutch(False)
    host.run(0.5)
    assert host.status().clutch is Clutch.SHIFTED
    assert np.abs(np.diff(references(host), axis=0)).max() < 0.01, "a count of the converter is 5 mrad, at a ratio of 2"
    lead(host, [0.0, 0.0, 0.0, 0.0])
    assert host.bench.angles == pytest.approx(held + 2 * np.array([0.3, -0.3, 0.3, -0.2]), abs=NEAR_RAD)
    assert well(host)
