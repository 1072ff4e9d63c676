"""Timer/counters: periods, flags, 16-bit access, and the duty that the PWM registers command."""

from __future__ import annotations

from itertools import pairwise

import pytest

from tests.simulated_board.avr import MakeProgram

PERIOD = """
volatile uint16_t stamp[4]; volatile uint8_t count;
ISR({vector}) {{ stamp[count++] = TCNT5; if (count == 4) DONE(); }}
int main(void) {{ TCCR5B = 1; {setup} sei(); for (;;); }}
"""
PERIODS = [
    ("CTC, 1 kHz tick of the firmware", "TIMER0_COMPA_vect", "TCCR0A = 2; OCR0A = 249; TIMSK0 = 2; TCCR0B = 3;", 16000),
    ("CTC at ICR", "TIMER1_COMPB_vect", "ICR1 = 999; OCR1B = 500; TIMSK1 = 4; TCCR1B = 0x19;", 1000),
    ("normal, 8 bits", "TIMER2_OVF_vect", "TIMSK2 = 1; TCCR2B = 3;", 256 * 32),
    ("phase correct at ICR", "TIMER3_OVF_vect", "ICR3 = 400; TCCR3A = 0; TIMSK3 = 1; TCCR3B = 0x11;", 800),
    ("phase correct, 8 bits", "TIMER2_OVF_vect", "TCCR2A = 1; TIMSK2 = 1; TCCR2B = 2;", 510 * 8),
    ("fast PWM, 10 bits", "TIMER4_OVF_vect", "TCCR4A = 3; TIMSK4 = 1; TCCR4B = 0x09;", 1024),
]


@pytest.mark.parametrize(
    ("vector", "setup", "cycles"), [case[1:] for case in PERIODS], ids=[case[0] for case in PERIODS]
)
def test_interrupts_come_at_the_period_of_the_mode(program: MakeProgram, vector: str, setup: str, cycles: int) -> None:
    stamps = program(PERIOD.format(vector=vector, setup=setup)).finish().u16("stamp")
    steps = [(later - earlier) % 65536 for earlier, later in pairwise(stamps)]
    assert all(abs(step - cycles) <= 2 for step in steps), steps
    assert abs(sum(steps) - 3 * cycles) <= 2  # no drift


def test_a_phase_correct_counter_matches_on_the_way_up_and_down(program: MakeProgram) -> None:
    setup = "ICR3 = 400; OCR3A = 100; TIMSK3 = 2; TCCR3B = 0x11;"
    stamps = program(PERIOD.format(vector="TIMER3_COMPA_vect", setup=setup)).finish().u16("stamp")
    steps = [later - earlier for earlier, later in pairwise(stamps)]
    assert sorted(steps[:2]) == pytest.approx([200, 600], abs=2)
    assert steps[2] == pytest.approx(steps[0], abs=2)


COUNT = """
volatile uint16_t seen[3]; volatile uint8_t low;
int main(void) {
    TCNT1 = 0x12FE; TCCR1B = 1;
    seen[0] = TCNT1;
    __builtin_avr_delay_cycles(1000);
    seen[1] = TCNT1;
    TCCR1B = 0; __builtin_avr_delay_cycles(100);
    OCR3AH = 0x12; low = OCR3AH; OCR3AL = 0x34; seen[2] = OCR3A;
    DONE();
}
"""


def test_the_counter_counts_cycles_and_16_bit_values_go_through_the_temporary_register(program: MakeProgram) -> None:
    run = program(COUNT).finish()
    first, second, compare = run.u16("seen")
    assert 0x12FE <= first <= 0x1303
    assert 1000 <= second - first <= 1010
    assert run.u8("low") == [0]  # the high byte waits for the low one
    assert compare == 0x1234


FLAGS = """
volatile uint8_t seen[4], fired;
ISR(TIMER1_COMPA_vect) { ++fired; }
int main(void) {
    OCR1A = 10; OCR1B = 20; TCCR1B = 1; __builtin_avr_delay_cycles(100);
    seen[0] = TIFR1; TIFR1 = _BV(OCF1B); seen[1] = TIFR1;
    sei(); __builtin_avr_delay_cycles(10); seen[2] = fired;
    TIMSK1 = _BV(OCIE1A); __builtin_avr_delay_cycles(10); seen[3] = TIFR1;
    DONE();
}
"""


def test_flags_wait_for_their_interrupt_and_clear_by_writing_one(program: MakeProgram) -> None:
    """A flag that was set before its interrupt is enabled fires at once; serving it clears the flag."""
    run = program(FLAGS).finish()
    ocfa, ocfb = 0x02, 0x04
    first, second, handled, last = run.u8("seen")
    assert [flags & (ocfa | ocfb) for flags in (first, second, last)] == [ocfa | ocfb, ocfa, 0]
    assert handled == 0
    assert run.u8("fired") == [1]


SBI = """
volatile uint8_t seen[2];
int main(void) {
    OCR1A = 10; OCR1B = 20; TCCR1B = 1; __builtin_avr_delay_cycles(100);
    __asm__ volatile("sbi %0, %1" :: "I"(_SFR_IO_ADDR(TIFR1)), "I"(OCF1A)); seen[0] = TIFR1;
    DDRB = 0xFF; PORTB = 0x55; __asm__ volatile("sbi %0, 1" :: "I"(_SFR_IO_ADDR(PINB))); seen[1] = PINB;
    DONE();
}
"""


def test_sbi_touches_one_bit_of_a_flag_or_pin_register(program: MakeProgram) -> None:
    flags, pins = program(SBI).finish().u8("seen")
    assert flags & 0x06 == 0x04
    assert pins == 0x57


MEGA, NANO = "atmega2560", "atmega328p"
PHASE_400 = "DDRE = 8; ICR3 = 400; TCCR3A = 0x{com}; TCCR3B = 0x11; OCR3A = {value};"
DUTIES = [
    ("firmware's, off", MEGA, PHASE_400.format(com="80", value=0), 3, "A", 0.0),
    ("firmware's, quarter", MEGA, PHASE_400.format(com="80", value=100), 3, "A", 0.25),
    ("firmware's, above top", MEGA, PHASE_400.format(com="80", value=500), 3, "A", 1.0),
    ("inverted", MEGA, PHASE_400.format(com="C0", value=100), 3, "A", 0.75),
    ("timer 4 C", MEGA, "DDRH = 0x20; ICR4 = 400; TCCR4A = 0x08; TCCR4B = 0x11; OCR4C = 40;", 4, "C", 0.1),
    ("pin is an input", MEGA, "ICR3 = 400; TCCR3A = 0x80; TCCR3B = 0x11; OCR3A = 100;", 3, "A", 0.0),
    ("disconnected, port low", MEGA, PHASE_400.format(com="00", value=100), 3, "A", 0.0),
    ("disconnected, port high", MEGA, PHASE_400.format(com="00", value=100) + "PORTE = 8;", 3, "A", 1.0),
    ("stopped", MEGA, PHASE_400.format(com="80", value=100).replace("0x11", "0x10"), 3, "A", 0.0),
    ("Nano timer 1 B", NANO, "DDRB = 4; ICR1 = 400; TCCR1A = 0x20; TCCR1B = 0x11; OCR1B = 300;", 1, "B", 0.75),
    ("Nano timer 2, phase correct", NANO, "DDRB = 8; TCCR2A = 0x81; TCCR2B = 1; OCR2A = 51;", 2, "A", 0.2),
    ("Nano timer 2, fast", NANO, "DDRD = 8; TCCR2A = 0x23; TCCR2B = 1; OCR2B = 63;", 2, "B", 0.25),
    ("fast PWM is never quite off", NANO, "DDRD = 8; TCCR2A = 0x23; TCCR2B = 1; OCR2B = 0;", 2, "B", 1 / 256),
    ("analogWrite, 8 bits of timer 1", NANO, "DDRB = 2; TCCR1A = 0x81; TCCR1B = 3; OCR1A = 128;", 1, "A", 128 / 255),
    ("fast PWM at OCRA", NANO, "DDRB = 4; TCCR1A = 0x23; TCCR1B = 0x19; OCR1A = 99; OCR1B = 49;", 1, "B", 0.5),
    ("toggle on match", NANO, "DDRB = 2; TCCR1A = 0x40; TCCR1B = 0x09; OCR1A = 99;", 1, "A", 0.5),
]


@pytest.mark.parametrize(
    ("chip", "setup", "timer", "channel", "duty"), [d[1:] for d in DUTIES], ids=[d[0] for d in DUTIES]
)
def test_duty_is_what_the_registers_command(
    program: MakeProgram, chip: str, setup: str, timer: int, channel: str, duty: float
) -> None:
    run = program("int main(void) { " + setup + " for (;;); }", chip)
    index = run.board.add_duty_output(timer, channel)
    run.start()
    run.run(5000)
    assert run.board.duty(timer, channel) == pytest.approx(duty)
    assert run.board.outputs()[index] == pytest.approx(duty)


PINS = "int main(void) { DDRA = 0x0F; PORTA = 0x3C; DDRH = 0x40; PORTH = 0x40; for (;;); }"


def test_a_pin_is_high_when_it_is_an_output_and_driven_high(program: MakeProgram) -> None:
    run = program(PINS)
    board = run.board
    places = [board.add_pin_output("A", bit) for bit in range(8)] + [board.add_pin_output("H", 6)]
    run.start()
    assert not board.outputs().any()
    run.run(1000)
    values = board.outputs()
    assert [values[place] for place in places] == [0, 0, 1, 1, 0, 0, 0, 0, 1]
    assert board.outputs() is values
    assert board.pin("A", 2)
    assert not board.pin("A", 4)
