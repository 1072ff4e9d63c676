"""An input whose wire is off, on the real images: found within 45 ms, with the motors on and off, whatever it reads."""

from __future__ import annotations

import pytest

from greywhale.protocol import schema
from greywhale_sim.board_with_image import BoardWithImage
from tests.firmware.conftest import enable, ms_until_off

FOUND_MS = 45  # five readings after ground, one in eight ticks


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
