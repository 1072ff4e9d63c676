"""A processor that hangs with its interrupts off, on the real images: the watchdog turns the motors off."""

from __future__ import annotations

import struct

import pytest

from greywhale.protocol import schema
from tests.firmware.test_stop import motors_on, status
from tools.bench.bench_tick import CYCLES_PER_TICK, Bench

PHASES = 40
OFF_MS = 20.0


def hang(bench: Bench) -> None:
    """Send the processor into avr-libc's endless loop behind main(), which begins with turning interrupts off."""
    bench.board.pc = bench.symbols["_exit"].address


def ms_until_off(bench: Bench) -> float:
    begun = bench.board.cycle
    while motors_on(bench):
        bench.board.run_until(bench.board.cycle + 200)
    return float((bench.board.cycle - begun) / CYCLES_PER_TICK)


@pytest.mark.slow
def test_a_hang_with_interrupts_off_turns_the_motors_off_within_20_ms(bench: Bench) -> None:
    for _ in range(PHASES):
        bench.ask(schema.ClearFaultRequest)
        bench.ask(schema.EnableRequest, struct.pack("<H", 0))
        bench.wait(bench.random.uniform(5, 40))
        hang(bench)
        assert ms_until_off(bench) < OFF_MS
        bench.wait(60)
        seen = status(bench)
        assert (seen.state, seen.fault) == (schema.State.FAULT, schema.Fault.WATCHDOG)
        assert not motors_on(bench)


@pytest.mark.slow
def test_the_watchdog_leaves_boot_and_every_step_of_a_parameter_set_alone(bench: Bench) -> None:
    """Staged, applied, saved into both banks, with telemetry on and a reset at the end: the watchdog never bites."""
    bench.ask(schema.TelemetryRequest, struct.pack("<H", 1))
    values = list(schema.DEFAULTS)
    for soft_start_ms in (700, 800, 900):
        index = schema.PARAMETER_BY_NAME["soft_start_ms"].index
        values[index] = soft_start_ms
        bench.ask(schema.ParamSetRequest, struct.pack("<Hi", index, soft_start_ms))
        bench.ask(schema.ParamApplyRequest, struct.pack("<H", schema.param_crc(values)))
        bench.ask(schema.ParamSaveRequest)
        bench.wait(1000)
        assert status(bench).save_state is schema.SaveState.SAVED
    bench.board.reset()
    bench.wait(60)
    assert status(bench).fault is schema.Fault.NONE
    assert bench.board.stats().watchdog_resets == 0
