"""A hunting joint on the real images: how soon the motors are off."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.protocol import schema
from greywhale_sim.board_with_image import CYCLES_PER_TICK, BoardWithImage
from tests.firmware.conftest import apply, enable

MILLIVOLTS_A_RAD = 5000.0 / np.deg2rad(300.0)
FOLLOWER = 4  # the first of its pots
PATIENCE_MS = 2500


def shake(bench: BoardWithImage, pot: int, amplitude: float, hertz: float) -> float | None:
    """Swing a follower's pot by so many rad; the ms until the motors are off, if they go off."""
    phase = bench.random.uniform(0, 2 * np.pi)
    bench.wait(bench.random.uniform(0, 200))
    begun = bench.board.cycle
    for _ in range(4 * PATIENCE_MS):
        ms = (bench.board.cycle - begun) / CYCLES_PER_TICK
        millivolts = bench.millivolts.copy()
        millivolts[pot] += amplitude * np.sin(2 * np.pi * hertz * ms / 1000 + phase) * MILLIVOLTS_A_RAD
        bench.board.set_millivolts(millivolts)
        bench.wait(0.25)
        if not bench.motors_on:
            return float(ms)
    return None


@pytest.mark.slow
def test_a_hunting_joint_is_off_within_a_second_and_a_half_whenever_it_begins(bench: BoardWithImage) -> None:
    took = []
    for joint in range(4):
        bench.board.set_millivolts(bench.millivolts)
        bench.wait(50)
        enable(bench)
        off = shake(bench, FOLLOWER + joint, bench.random.uniform(0.015, 0.1), bench.random.uniform(3.5, 15))
        assert off is not None
        took.append(off)
        seen = bench.status()
        assert (seen.fault, seen.fault_where, seen.late_ticks) == (schema.Fault.UNREST, joint, 0)
    assert min(took) >= 1100
    assert max(took) <= 1550


@pytest.mark.slow
def test_the_safe_set_takes_over_within_some_ticks_and_none_is_late(bench: BoardWithImage) -> None:
    apply(bench, "unrest_action", 1)
    enable(bench)
    assert shake(bench, FOLLOWER + 1, 0.05, 8.0) is not None
    bench.board.set_millivolts(bench.millivolts)
    off_at = bench.board.cycle
    while not bench.motors_on:
        bench.wait(0.1)
        assert bench.board.cycle - off_at < 12 * CYCLES_PER_TICK
    seen = bench.status()
    assert (seen.state, seen.fault, seen.late_ticks) == (schema.State.SOFT_START, schema.Fault.UNREST, 0)
    bench.wait(1200)
    assert bench.status().state is schema.State.FOLLOWING
