"""Interrupts: their cost in cycles, and the order in which they come."""

from __future__ import annotations

import pytest

from tests.simulated_board.avr import MakeProgram

# The handler reads the counter in its first instruction; Timer1 matches at 1000, with the flag one clock later.
LATENCY = """
volatile uint16_t stamp;
ISR(TIMER1_COMPA_vect, ISR_NAKED) {
    __asm__ volatile("lds r24, %0\\n lds r25, %0+1\\n sts stamp, r24\\n sts stamp+1, r25" :: "n"(_SFR_MEM_ADDR(TCNT1)));
    DONE();
}
int main(void) {
    OCR1A = 1000; TIMSK1 = _BV(OCIE1A); sleep_enable(); TCCR1B = 1; sei();
    WAIT
}
"""
NOPS = '__asm__ volatile(".rept 1200\\n nop\\n .endr");  for (;;);'
SLEEP = "for (;;) sleep_cpu();"
FLAG_SET, VECTOR_JUMP = 1001, 3


@pytest.mark.parametrize(("chip", "entry"), [("atmega2560", 5), ("atmega328p", 4)])
def test_entry_takes_4_cycles_5_with_a_22_bit_program_counter_and_as_many_more_from_sleep(
    program: MakeProgram, chip: str, entry: int
) -> None:
    awake = program(LATENCY.replace("WAIT", NOPS), chip).finish().u16("stamp")[0]
    asleep = program(LATENCY.replace("WAIT", SLEEP), chip).finish().u16("stamp")[0]
    assert awake == FLAG_SET + entry + VECTOR_JUMP
    assert asleep == FLAG_SET + 2 * entry + VECTOR_JUMP


HANDLER = """
ISR(TIMER1_COMPA_vect, ISR_NAKED) { __asm__ volatile("nop\\n nop\\n reti"); }
int main(void) { OCR1A = 1999; TIMSK1 = _BV(OCIE1A); TCCR1B = _BV(WGM12) | 1; sei(); for (;;); }
"""


@pytest.mark.parametrize(
    ("chip", "vector", "cycles"), [("atmega2560", 17, 5 + 3 + 2 + 5), ("atmega328p", 11, 4 + 3 + 2 + 4)]
)
def test_handler_statistics_count_entry_and_reti(program: MakeProgram, chip: str, vector: int, cycles: int) -> None:
    run = program(HANDLER, chip).start()
    run.run(20_500)
    times = run.board.stats().vectors
    assert list(times) == [vector]
    assert (times[vector].count, times[vector].min, times[vector].mean, times[vector].max) == (
        10,
        cycles,
        cycles,
        cycles,
    )


ONE_STEP = """
volatile uint16_t handled;
ISR(USART0_UDRE_vect, ISR_NAKED) {
    __asm__ volatile("cpi r20, 10\\n brsh 1f\\n inc r21\\n reti\\n 1: sts handled, r20\\n sts handled+1, r21");
    DONE();
}
int main(void) {
    UCSR0B = _BV(TXEN0) | _BV(UDRIE0);
    __asm__ volatile("clr r20\\n clr r21\\n sei\\n .rept 20\\n inc r20\\n .endr");
    for (;;);
}
"""


def test_one_instruction_runs_between_sei_or_reti_and_the_next_interrupt(program: MakeProgram) -> None:
    """With a request always there, ten increments need ten interrupts."""
    assert program(ONE_STEP).finish().u8("handled") == [10, 9]


PRIORITY = """
volatile uint8_t order[3], count;
ISR(TIMER1_COMPA_vect) { order[count++] = 'A'; }
ISR(TIMER1_COMPB_vect) { order[count++] = 'B'; }
ISR(USART0_UDRE_vect) { order[count++] = 'U'; UCSR0B = 0; }
int main(void) {
    OCR1A = 100; OCR1B = 50; TCCR1B = 1; UCSR0B = _BV(TXEN0) | _BV(UDRIE0);
    TIMSK1 = _BV(OCIE1B) | _BV(OCIE1A);
    __builtin_avr_delay_cycles(500); sei(); while (count < 3); DONE();
}
"""


def test_pending_interrupts_are_served_by_vector_number(program: MakeProgram) -> None:
    assert bytes(program(PRIORITY).finish().u8("order")) == b"ABU"


WITHDRAWN = """
volatile uint8_t steps;
ISR(EE_READY_vect, ISR_NAKED) { __asm__ volatile("sts steps, r20"); DONE(); }
int main(void) {
    UCSR0B = _BV(TXEN0) | _BV(UDRIE0); UCSR0B = REST; EECR = _BV(EERIE);
    __asm__ volatile("clr r20\\n sei\\n inc r20\\n inc r20\\n inc r20");
    for (;;);
}
"""


@pytest.mark.parametrize("rest", ["0", "_BV(TXEN0)"])
def test_a_request_that_was_withdrawn_does_not_delay_another(program: MakeProgram, rest: str) -> None:
    assert program(WITHDRAWN.replace("REST", rest)).finish().u8("steps") == [1]


SLEEPER = """
volatile uint16_t ticks;
ISR(TIMER0_COMPA_vect) { ++ticks; }
int main(void) {
    TCCR0A = _BV(WGM01); OCR0A = 249; TCCR0B = 3; TIMSK0 = _BV(OCIE0A); SETUP
    sei(); for (;;) sleep_cpu();
}
"""


def test_sleep_needs_its_enable_bit_and_counts_as_idle_time(program: MakeProgram) -> None:
    idle = program(SLEEPER.replace("SETUP", "sleep_enable();")).start()
    busy = program(SLEEPER.replace("SETUP", "")).start()
    for run in (idle, busy):
        run.run(1_600_000)
        assert run.u16("ticks") == [99]
    assert idle.board.stats().sleep_cycles > 1_580_000
    assert busy.board.stats().sleep_cycles == 0


def test_sleep_without_its_enable_bit_goes_on_with_interrupts_off_too(program: MakeProgram) -> None:
    run = program("volatile uint8_t passed; int main(void) { cli(); sleep_cpu(); passed = 1; DONE(); }").finish()
    assert run.u8("passed") == [1]
