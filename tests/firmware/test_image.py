"""A host that babbles at the real firmware images: no motor starts, no tick is late."""

from __future__ import annotations

from greywhale.protocol import schema
from greywhale_sim.board_with_image import BoardWithImage

BYTES_A_MS = 100  # what the wire carries at 1 Mbaud


def babble(bench: BoardWithImage, ms: int) -> None:
    """Random bytes without a gap; at the end a zero, so that the next frame is not taken for part of the noise."""
    bench.board.uart_send(bench.random.bytes(ms * BYTES_A_MS) + b"\0")
    bench.wait(ms + 2)


def test_a_babbling_host_neither_starts_the_motors_nor_delays_a_tick(bench: BoardWithImage) -> None:
    babble(bench, 1000)
    seen = bench.status()
    assert seen.state == schema.State.DISABLED
    assert seen.late_ticks == 0
    assert seen.frames_bad > 0
    assert seen.rx_overruns > 0


def test_a_babbling_host_delays_no_tick_of_a_moving_arm_and_ends_in_a_fault(bench: BoardWithImage) -> None:
    bench.ask(schema.TelemetryRequest(1))
    bench.ask(schema.EnableRequest(0))
    babble(bench, 500)
    seen = bench.status()
    assert (seen.state, seen.fault) == (schema.State.FAULT, schema.Fault.FLOOD)
    assert seen.late_ticks == 0
    assert bench.ask(schema.ClearFaultRequest()).state == schema.State.DISABLED
