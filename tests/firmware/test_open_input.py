"""An input whose wire is off, or touches another's, on the real images: found within 45 ms, whatever it reads."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.protocol import schema
from greywhale_sim.board_with_image import UNWATCHED, BoardWithImage
from tests.firmware.conftest import enable, ms_until_off

FOUND_MS = 45  # five probes, one in eight ticks
SLICES = 40_000  # of 0.25 ms


@pytest.mark.parametrize("pot", [2, 5])
def test_it_turns_the_motors_off_and_keeps_them_off_until_it_is_connected(bench: BoardWithImage, pot: int) -> None:
    """All pots read alike here, so that nothing jumps."""
    bench.wait(60)
    enable(bench)
    bench.wait(100)
    bench.board.set_floating(1 << pot)
    assert ms_until_off(bench) < FOUND_MS
    status = bench.status()
    assert (status.fault, status.fault_where) == (schema.Fault.POT_LOW, pot)
    bench.wait(100)
    with pytest.raises(RuntimeError, match="ClearFault"):
        bench.ask(schema.ClearFaultRequest())
    bench.board.set_floating(0)
    bench.wait(FOUND_MS)
    enable(bench)


def test_the_motors_do_not_start_with_it(bench: BoardWithImage) -> None:
    bench.wait(60)
    bench.board.set_floating(1 << 4)
    bench.wait(FOUND_MS)
    with pytest.raises(RuntimeError, match="Enable"):
        bench.ask(schema.EnableRequest(0))


@pytest.mark.parametrize(("first", "second", "wipers"), [(4, 5, 2), (2, 7, 1)])
def test_wires_that_touch_turn_the_motors_off(bench: BoardWithImage, first: int, second: int, wipers: int) -> None:
    """With two wipers on the wire, or with one while the other potentiometer's wire is off."""
    bench.wait(60)
    enable(bench)
    bench.wait(100)
    bench.board.set_joined(1 << first | 1 << second, wipers)
    assert ms_until_off(bench) < FOUND_MS
    status = bench.status()
    assert status.fault == schema.Fault.POT_HIGH
    assert status.fault_where in (first, second)
    bench.board.set_joined(0, 1)
    bench.wait(FOUND_MS)
    enable(bench)


def test_noise_is_no_wire_that_touches(bench: BoardWithImage) -> None:
    """20 mV rms, eight times that of a usual potentiometer, on all of them."""
    random = np.random.default_rng(1)
    bench.apply(UNWATCHED)
    enable(bench)
    for _ in range(SLICES):
        bench.board.set_millivolts(random.normal(2500.0, 20.0, 8))
        bench.wait(0.25)
    assert bench.status().state is schema.State.FOLLOWING
