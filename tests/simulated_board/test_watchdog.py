"""The watchdog: its interrupt, the sequence that guards it, and its times."""

from __future__ import annotations

import pytest

from tests.simulated_board.avr import MakeProgram

CHIPS = ["atmega2560", "atmega328p"]
SHORTEST = 256_000  # cycles: 2048 of 128 kHz
WINDOW = "cli(); wdt_reset(); WDTCSR = _BV(WDCE) | _BV(WDE); WDTCSR = "

MODES = """
volatile uint8_t count, seen, cause __attribute__((section(".noinit")));
ISR(WDT_vect) { ++count; seen = WDTCSR; }
int main(void) {
    cause = MCUSR;
    MCUSR = 0;
    if (cause & _BV(WDRF)) { wdt_disable(); DONE(); }
    WINDOW MODE; sei();
    for (;;);
}
""".replace("WINDOW", WINDOW)


@pytest.mark.parametrize("chip", CHIPS)
def test_its_interrupt_comes_each_time_and_nothing_is_reset(program: MakeProgram, chip: str) -> None:
    run = program(MODES.replace("MODE", "_BV(WDIE) | _BV(WDP0)"), chip).start()
    run.run(7 * SHORTEST)
    assert run.u8("count") == [3]
    assert run.u8("seen") == [0x41], "the flag is cleared, the interrupt still enabled"
    assert run.board.stats().watchdog_resets == 0


@pytest.mark.parametrize("chip", CHIPS)
def test_with_both_modes_the_interrupt_switches_itself_off_and_the_reset_follows(
    program: MakeProgram, chip: str
) -> None:
    run = program(MODES.replace("MODE", "_BV(WDIE) | _BV(WDE)"), chip).start()
    run.run(2 * SHORTEST - 100)
    assert (run.u8("count"), run.u8("seen")) == ([1], [0x08])
    assert run.board.stats().watchdog_resets == 0
    run.run(1000)
    assert run.u8("cause") == [8]
    assert run.board.stats().watchdog_resets == 1


def test_an_interrupt_that_nobody_enters_is_followed_by_the_reset_too(program: MakeProgram) -> None:
    run = program(MODES.replace("MODE; sei();", "_BV(WDIE) | _BV(WDE);")).start()
    run.run(2 * SHORTEST + 1000)
    assert run.u8("cause") == [8]
    assert run.board.stats().watchdog_resets == 1


def test_it_resets_a_sleeping_chip_at_its_time(program: MakeProgram) -> None:
    source = "int main(void) { MCUSR = 0; wdt_enable(WDTO_15MS); sleep_enable(); sei(); for (;;) sleep_cpu(); }"
    run = program(source).start()
    run.run(SHORTEST)
    asleep = run.board.stats().sleep_cycles
    run.run(200)
    assert run.board.stats().watchdog_resets == 1
    assert run.board.stats().sleep_cycles < asleep + 200


def test_it_resets_a_chip_that_sleeps_without_interrupts(program: MakeProgram) -> None:
    run = program("int main(void) { MCUSR = 0; wdt_enable(WDTO_15MS); DONE(); }").start()
    run.run(SHORTEST + 1000)
    assert run.board.stats().watchdog_resets == 1
    assert run.board.stats().sleep_cycles > SHORTEST - 1000


CHANGED = """
int main(void) {
    if (MCUSR & _BV(WDRF)) { MCUSR = 0; wdt_disable(); DONE(); }
    MCUSR = 0; wdt_enable(FROM);
    __builtin_avr_delay_cycles(600000);
    WDTCSR = _BV(WDCE) | _BV(WDE); WDTCSR = _BV(WDE) | TO;
    for (;;);
}
"""


@pytest.mark.parametrize(("before", "after", "resets_at"), [(2, 0, 600_000), (2, 1, 600_000), (2, 3, 8 * SHORTEST)])
def test_another_time_does_not_restart_its_counter(
    program: MakeProgram, before: int, after: int, resets_at: int
) -> None:
    """The data sheet: switching to a shorter time can result in a time-out."""
    run = program(CHANGED.replace("FROM", str(before)).replace("TO", str(after))).start()
    run.run(resets_at - 1000)
    assert run.board.stats().watchdog_resets == 0
    run.run(2000)
    assert run.board.stats().watchdog_resets == 1


GUARD = """
volatile uint8_t seen[4];
int main(void) {
    MCUSR = 0; cli();
    WDTCSR = _BV(WDE) | 7; seen[0] = WDTCSR;
    WDTCSR = 0; seen[1] = WDTCSR;
    WDTCSR = _BV(WDCE) | _BV(WDE);
    __asm__ volatile(".rept WAIT\\n nop\\n .endr");
    WDTCSR = 5; seen[2] = WDTCSR;
    __builtin_avr_delay_cycles(10); seen[3] = WDTCSR;
    for (;;);
}
"""


@pytest.mark.parametrize(("wait", "after"), [(0, 5), (2, 5), (4, 8)])
def test_it_is_switched_off_and_its_time_changed_within_four_cycles_only(
    program: MakeProgram, wait: int, after: int
) -> None:
    """WDE may be set at any time. The store that ends the window takes two cycles itself."""
    run = program(GUARD.replace("WAIT", str(wait))).start()
    run.run(SHORTEST // 2)
    assert run.u8("seen")[:2] == [8, 8]
    assert run.u8("seen")[2:] == [after, after]


def test_it_stays_on_while_mcusr_holds_its_reset(program: MakeProgram) -> None:
    source = f"""
    volatile uint8_t seen[2] __attribute__((section(".noinit")));
    int main(void) {{
        if (MCUSR & _BV(PORF)) {{ MCUSR = 0; wdt_enable(WDTO_15MS); for (;;); }}
        {WINDOW} 0; seen[0] = WDTCSR;
        MCUSR = 0; {WINDOW} 0; seen[1] = WDTCSR;
        DONE();
    }}
    """
    assert program(source).finish().u8("seen") == [8, 0]
