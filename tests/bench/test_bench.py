"""Lock step: whole slices, what the driver pins do to the arm, and when the arm is free."""

from __future__ import annotations

from typing import Any

import pytest

from greywhale_sim.bench import CRASHED, SLICE_CYCLES, Bench, CrashError

ENABLE, DUTY, DIRECTION = 0, slice(1, 5), slice(5, 9)


def test_run_takes_whole_slices_and_never_drifts(board: Any, bench: Bench) -> None:
    bench.run(0.1)
    assert board.cycle == 400 * SLICE_CYCLES + 1
    bench.run_slices(1)
    assert board.cycle == 401 * SLICE_CYCLES + 1
    assert len(board.millivolts) == 401


def test_follower_is_held_until_enabled_then_free(board: Any, plant: Any, bench: Bench) -> None:
    bench.run(0.01)
    assert plant.voltages == []
    assert plant.angles.tolist() == pytest.approx([0.0, 0.1, 0.2, 0.3])
    board.pins[ENABLE] = 1
    bench.run(0.01)
    assert len(plant.voltages) == 39  # 40 slices, and the first is needed to see the enable pin


def test_a_crash_is_told_with_its_address(board: Any, bench: Bench) -> None:
    board.result = CRASHED
    board.pc = 0x1234
    with pytest.raises(CrashError, match="address 0x01234: a write to nowhere"):
        bench.run(0.01)
