"""A processor that hangs, on the real images: its motors go off, and it says so after the restart.

With interrupts on the tick's interrupt restarts the program. With interrupts off the watchdog restarts the board, and
its bootloader decides what can be told. The bootloaders are the boards' own.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from greywhale.protocol import schema
from greywhale_sim.board_with_image import BoardWithImage
from greywhale_sim.programs import load_hex
from tests.firmware.conftest import enable, ms_until_off
from tests.simulated_board.stk500 import Version1, Version2

OFF_MS = 20.0
BOOTED_MS = 1500  # through either bootloader
SREG, INTERRUPTS_ON = 0x5F, 0x80
RESETS = 2


@pytest.fixture
def booted(bench: BoardWithImage) -> BoardWithImage:
    """A board whose bootloader has started the firmware."""
    load_hex(bench.board, bench.wiring.bootloader, bootloader=True)
    cut_power(bench)
    return bench


def is_nano(bench: BoardWithImage) -> bool:
    return bench.wiring.name == "nano"


def reset(bench: BoardWithImage) -> None:
    bench.board.reset()
    assert ms_until_off(bench) == 0.0
    bench.wait(BOOTED_MS)


def sink(bench: BoardWithImage) -> None:
    for millivolts in (2600, 5000):
        bench.board.set_supply(millivolts)
    bench.wait(BOOTED_MS)


def cut_power(bench: BoardWithImage) -> None:
    bench.board.power_off()
    bench.board.power_on(2)
    bench.wait(BOOTED_MS)


def flash_a_page(bench: BoardWithImage) -> None:
    """Its first page, as it is."""
    bench.board.reset()
    bench.wait(100)
    programmer = Version1(bench.board) if is_nano(bench) else Version2(bench.board)
    programmer.write_page(0, bench.board.flash()[: programmer.PAGE])
    programmer.leave()
    bench.wait(2 * BOOTED_MS)


def follow(bench: BoardWithImage) -> None:
    """Motors on, and some phase of a tick."""
    enable(bench)
    bench.wait(bench.random.uniform(5, 40))


def hang(bench: BoardWithImage) -> None:
    """Send the processor into avr-libc's endless loop behind main(), which begins with turning interrupts off."""
    bench.board.pc = bench.symbols["_exit"].address


def hang_with_interrupts_on(bench: BoardWithImage) -> None:
    """The same loop without its first instruction."""
    bench.board.poke(SREG, bytes([INTERRUPTS_ON]))
    bench.board.pc = bench.symbols["_exit"].address + 2


def go_astray(bench: BoardWithImage) -> None:
    """What a call through a null pointer does."""
    bench.board.pc = 0


def reset_cause(bench: BoardWithImage) -> schema.ResetCause:
    return bench.ask(schema.HelloRequest()).reset_cause


def see_it_stay_silent(nano: BoardWithImage) -> None:
    """Its bootloader leaves the watchdog on, which restarts it again and again until power is cut."""
    follow(nano)
    hang(nano)
    assert ms_until_off(nano) < OFF_MS
    for _ in range(2):
        nano.wait(20)
        before = nano.board.stats().watchdog_resets
        nano.wait(160)
        assert nano.board.stats().watchdog_resets == before + 10
        assert not nano.motors_on
        nano.board.reset()
    assert not nano.board.uart_receive()
    cut_power(nano)
    assert nano.status().fault is schema.Fault.NONE


@pytest.mark.parametrize("stop_working", [hang, hang_with_interrupts_on, go_astray])
def test_a_hang_is_told_through_the_bootloader_where_that_comes_back(
    booted: BoardWithImage, stop_working: Callable[[BoardWithImage], None]
) -> None:
    if is_nano(booted) and stop_working is hang:
        see_it_stay_silent(booted)
        return
    for _ in range(3):
        follow(booted)
        stop_working(booted)
        assert ms_until_off(booted) < OFF_MS
        booted.wait(60)  # so it did not wait for a host in its bootloader
        seen = booted.status()
        assert (seen.state, seen.fault) == (schema.State.FAULT, schema.Fault.WATCHDOG)
        assert reset_cause(booted) is schema.ResetCause.WATCHDOG


@pytest.mark.slow
def test_no_other_restart_is_taken_for_a_hang(booted: BoardWithImage) -> None:
    """The reset pin, as a host that opens the port uses it, with the motors on at any phase; a sunken supply; a power
    cut; and a host that flashes.
    """
    for restart in [*[reset] * RESETS, sink, cut_power, flash_a_page]:
        follow(booted)
        restart(booted)
        assert not booted.motors_on
        assert booted.duty() == 0.0
        assert reset_cause(booted) is not schema.ResetCause.WATCHDOG
        assert (booted.status().state, booted.status().fault) == (schema.State.DISABLED, schema.Fault.NONE)


@pytest.mark.slow
def test_the_watchdog_leaves_boot_and_every_step_of_a_parameter_set_alone(bench: BoardWithImage) -> None:
    """Staged, applied, saved into both banks, with telemetry on and a reset at the end: the watchdog never bites, and
    the board counts the sets that it has stored.
    """
    bench.ask(schema.TelemetryRequest(1))
    assert bench.status().saves == 0, "its EEPROM is blank"
    for saves, soft_start_ms in enumerate((700, 800, 800, 900)):
        bench.apply({"soft_start_ms": soft_start_ms}, fresh=True)
        bench.save()
        assert bench.status().saves == (saves + 1 if saves < 2 else saves), "the same set again writes nothing"
    bench.board.reset()
    bench.wait(100)
    assert (bench.status().fault, bench.status().saves) == (schema.Fault.NONE, 3)
    assert bench.board.stats().watchdog_resets == 0
