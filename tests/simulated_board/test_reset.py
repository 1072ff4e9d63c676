"""Power, the RESET pin, the watchdog: what each leaves in MCUSR, RAM and the registers."""

from __future__ import annotations

import numpy as np
import pytest

from tests.simulated_board.avr import MakeProgram

PORF, EXTRF = 1, 2

CAUSE = """
volatile uint8_t cause __attribute__((section(".noinit"))), kept __attribute__((section(".noinit")));
int main(void) { cause = MCUSR; if (CLEAR) MCUSR = 0; DDRB = 1; PORTB = 1; for (;;); }
"""


@pytest.mark.parametrize("chip", ["atmega2560", "atmega328p"])
def test_power_on_and_reset_pin_report_their_cause_and_reset_keeps_ram(program: MakeProgram, chip: str) -> None:
    run = program(CAUSE.replace("CLEAR", "1"), chip).start()
    run.run(1000)
    assert run.u8("cause") == [PORF]
    assert run.board.pin("B", 0)
    run.set_u8("kept", 0xA7)
    run.board.reset()
    assert not run.board.pin("B", 0)
    assert run.board.pc == 0
    run.run(1000)
    assert run.u8("cause") == [EXTRF]
    assert run.u8("kept") == [0xA7]


def test_ram_after_power_on_is_garbage_made_from_the_seed(program: MakeProgram) -> None:
    run = program(CAUSE.replace("CLEAR", "1"))
    memories = []
    for seed in (1, 2, 1):
        run.start(seed)
        memories.append(run.board.peek(0x400, 4096))
    assert memories[0] != memories[1]
    assert memories[0] == memories[2]
    assert len(set(memories[0])) == 256


BORF = 4


@pytest.mark.parametrize("chip", ["atmega2560", "atmega328p"])
def test_the_brown_out_detector_holds_the_chip_in_reset_and_memory_stays(program: MakeProgram, chip: str) -> None:
    run = program(CAUSE.replace("CLEAR", "1"), chip).start()
    run.run(1000)
    run.set_u8("kept", 0xA7)
    run.board.set_supply(2700)
    run.run(1000)
    assert run.board.pin("B", 0), "the level itself is enough"
    run.board.set_supply(2699)
    assert not run.board.pin("B", 0)
    at = run.board.cycle
    run.run(1000)
    run.board.set_supply(2749)
    run.run(1000)
    assert (run.board.pc, run.board.cycle) == (0, at + 2000)
    run.board.set_supply(2750)
    run.run(1000)
    assert run.u8("cause") == [BORF]
    assert run.u8("kept") == [0xA7]


def test_a_supply_that_falls_far_is_a_loss_of_power(program: MakeProgram) -> None:
    run = program(CAUSE.replace("CLEAR", "1")).start()
    run.run(1000)
    run.set_u8("kept", 0xA7)
    for millivolts in (2000, 1099):
        run.board.set_supply(millivolts)
    assert not run.board.powered
    run.board.set_supply(2000)
    assert not run.board.powered
    run.board.set_supply(5000, seed=3)
    run.run(1000)
    assert run.u8("cause") == [PORF]
    assert run.u8("kept") != [0xA7]


def test_the_converters_reference_is_the_supply(program: MakeProgram) -> None:
    source = """
    volatile uint16_t seen;
    int main(void) {
        ADMUX = 0x40; ADCSRA = _BV(ADEN) | _BV(ADSC) | 7;
        while (ADCSRA & _BV(ADSC)); seen = ADC; DONE();
    }
    """
    run = program(source)
    run.board.set_millivolts(np.full(8, 2000.0))
    run.board.set_supply(4000)
    assert run.finish().u16("seen") == [512]


def test_neither_its_reset_nor_the_reset_pin_ends_the_watchdog_but_a_power_cut_does(program: MakeProgram) -> None:
    """The flag WDRF keeps the watchdog on; a bootloader that leaves it set never gets beyond 16 ms."""
    source = "int main(void) { if (MCUSR & _BV(PORF)) { MCUSR = 0; wdt_enable(WDTO_15MS); } for (;;); }"
    run = program(source).start()
    run.run(300_000)
    for _ in range(2):
        run.board.reset()
        before = run.board.stats().watchdog_resets
        run.run(300_000)
        assert run.board.stats().watchdog_resets == before + 1
    run.board.power_off()
    before = run.board.stats().watchdog_resets
    run.start()
    run.run(200_000)
    assert run.board.stats().watchdog_resets == before


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("*(volatile uint8_t *)0x5000 = 1;", "a write beyond the end of RAM, to 0x5000"),
        ('__asm__ volatile(".word 0x9404");', "an invalid instruction, 0x9404"),
    ],
)
def test_a_program_that_does_the_impossible_has_crashed(program: MakeProgram, body: str, words: str) -> None:
    run = program("int main(void) { " + body + " for (;;); }").start()
    assert run.run(10_000) == 2
    assert words in run.board.crash_reason
    at = run.board.cycle
    assert run.run(10_000) == 2
    assert run.board.cycle == at
