"""A hunting joint on the real images: how soon the motors are off, and what it costs."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.protocol import schema
from greywhale_sim.board_with_image import CYCLES_PER_TICK, BoardWithImage
from tests.firmware.conftest import apply, enable

MILLIVOLTS_A_RAD = 5000.0 / np.deg2rad(300.0)
FOLLOWER = 4  # the first of its pots
PATIENCE_MS = 2500


def shake(bench: BoardWithImage, pot: int, amplitude: float, hertz: float, leader: float = 0.0) -> float | None:
    """Swing a follower's pot, and its leader's, by so many rad; the ms until the motors are off, if they go off."""
    phase, begun = bench.random.uniform(0, 2 * np.pi), bench.board.cycle
    bench.wait(bench.random.uniform(0, 200))
    begun = bench.board.cycle
    for _ in range(4 * PATIENCE_MS):
        ms = (bench.board.cycle - begun) / CYCLES_PER_TICK
        swing = np.sin(2 * np.pi * hertz * ms / 1000 + phase) * MILLIVOLTS_A_RAD
        millivolts = bench.millivolts.copy()
        millivolts[pot] += amplitude * swing
        millivolts[pot - FOLLOWER] += leader * swing
        bench.board.set_millivolts(millivolts)
        bench.wait(0.25)
        if not bench.motors_on:
            return float(ms)
    return None


@pytest.mark.slow
def test_a_hunting_joint_is_off_within_a_second_and_a_half_whenever_it_begins(bench: BoardWithImage) -> None:
    took = []
    for trial in range(12):
        bench.board.set_millivolts(bench.millivolts)
        bench.wait(50)
        enable(bench)
        joint = trial % 4
        off = shake(bench, FOLLOWER + joint, bench.random.uniform(0.015, 0.1), bench.random.uniform(3.5, 15))
        assert off is not None
        took.append(off)
        seen = bench.status()
        assert (seen.fault, seen.fault_where, seen.late_ticks) == (schema.Fault.UNREST, joint, 0)
    assert min(took) >= 1100
    assert max(took) <= 1550


def test_a_joint_that_swings_with_its_leader_keeps_its_motors(bench: BoardWithImage) -> None:
    enable(bench)
    assert shake(bench, FOLLOWER + 2, 0.05, 6.0, leader=-0.05) is None
    assert bench.status().fault is schema.Fault.NONE


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


def test_looking_for_unrest_costs_the_tick_nothing(bench: BoardWithImage) -> None:
    worst = []
    for amplitude in (0, 10):
        apply(bench, "unrest_amplitude", amplitude)
        enable(bench)
        bench.wait(1100)
        worst.append(max(bench.tick_cycles()[1] for _ in range(60)))
        bench.ask(schema.StopRequest())
    assert worst[1] <= worst[0] + 10  # the same work: the pots are at rest
