"""ADC: conversion time, the moment of sampling, what is latched when, flags and the result lock."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.simulated_board.avr import MakeProgram

CHIPS = ["atmega2560", "atmega328p"]


def millivolts(*values: float) -> NDArray[np.float64]:
    return np.array([*values, *[0.0] * (8 - len(values))])


SPACING = """
volatile uint16_t stamp[5]; volatile uint8_t count;
ISR(ADC_vect) {{ stamp[count++] = TCNT1; if (count == 5) DONE(); }}
int main(void) {{
    TCCR1B = 1; ADMUX = 0x40; ADCSRB = 0;
    ADCSRA = _BV(ADEN) | _BV(ADSC) | _BV(ADATE) | _BV(ADIE) | {select};
    stamp[0] = TCNT1; count = 1; sei(); for (;;);
}}
"""


@pytest.mark.parametrize("chip", CHIPS)
@pytest.mark.parametrize(("select", "prescaler"), [(4, 16), (7, 128)])
def test_free_running_conversions_take_13_adc_clocks_and_the_first_25(
    program: MakeProgram, chip: str, select: int, prescaler: int
) -> None:
    run = program(SPACING.format(select=select), chip).finish()
    stamps = run.u16("stamp")
    steps = [later - earlier for earlier, later in pairwise(stamps)]
    assert 25 * prescaler <= steps[0] + 10 <= 25 * prescaler + 60  # to inside the handler, from a store before
    assert all(abs(step - 13 * prescaler) <= 2 for step in steps[1:]), steps


SINGLE = """
volatile uint16_t took, result[3];
ISR(ADC_vect) { took = TCNT1; }
static void convert(uint8_t i) {
    took = 0; TCNT1 = 0; ADCSRA |= _BV(ADSC);
    while (!took); result[i] = took;
}
int main(void) {
    TCCR1B = 1; ADMUX = 0x40; ADCSRA = _BV(ADEN) | _BV(ADIE) | 5; sei();
    for (uint8_t i = 0; i < 3; ++i) convert(i);
    DONE();
}
"""


def test_a_single_conversion_starts_at_the_next_adc_clock(program: MakeProgram) -> None:
    """13 clocks of 32 cycles, up to one clock of waiting before, and the way into the handler after."""
    first, *others = program(SINGLE).finish().u16("result")
    assert 25 * 32 <= first <= 26 * 32 + 40
    for took in others:
        assert 13 * 32 <= took <= 14 * 32 + 40


EACH = """
volatile uint16_t result[8];
int main(void) {
    ADCSRA = _BV(ADEN) | 5;
    for (uint8_t i = 0; i < 8; ++i) {
        ADMUX = 0x40 | i; ADCSRA |= _BV(ADSC); while (ADCSRA & _BV(ADSC)); result[i] = ADC;
    }
    DONE();
}
"""


@pytest.mark.parametrize("chip", CHIPS)
def test_the_result_is_the_channels_input_over_the_reference(program: MakeProgram, chip: str) -> None:
    run = program(EACH, chip)
    run.board.set_millivolts(millivolts(0, 4.9, 4.8, 1234.5, 2500, 4995, 5000, 6000))
    assert run.finish().u16("result") == [0, 1, 0, 252, 512, 1022, 1023, 1023]


def test_a_floating_input_reads_what_the_conversion_before_left(program: MakeProgram) -> None:
    run = program(EACH)
    run.board.set_millivolts(np.array([500.0 * channel for channel in range(8)]))
    run.board.set_floating(1 << 3 | 1 << 6 | 1 << 7)
    counts = [500 * channel * 1024 // 5000 for channel in (0, 1, 2, 2, 4, 5, 5, 5)]
    assert run.finish().u16("result") == counts
    run.board.set_floating(0)
    assert run.finish().u16("result")[3] == 1500 * 1024 // 5000


PULLED = """
volatile uint16_t result[4];
static uint16_t convert(uint8_t input) {
    ADMUX = 0x40 | input; ADCSRA |= _BV(ADSC); while (ADCSRA & _BV(ADSC)); return ADC;
}
int main(void) {
    ADCSRA = _BV(ADEN) | 5;
    %(port)s = 1 << 2;
    result[0] = convert(2); result[1] = convert(3); result[2] = convert(4);
    %(port)s = 0; result[3] = convert(2);
    DONE();
}
"""


@pytest.mark.parametrize(("chip", "port"), [("atmega2560", "PORTF"), ("atmega328p", "PORTC")])
@pytest.mark.parametrize(("wipers", "source"), [(1, 2100.0), (2, 1050.0)])
def test_a_pull_up_raises_its_wire_at_every_input_that_the_wire_is_on(
    program: MakeProgram, chip: str, port: str, wipers: int, source: float
) -> None:
    """A divider of 35 kOhm to the supply and the track's resistance at the wiper, here 7 kOhm beside 3 kOhm of 10."""
    run = program(PULLED % {"port": port}, chip)
    run.board.set_millivolts(np.full(8, 1500.0))
    run.board.set_joined(1 << 2 | 1 << 4, wipers)
    own = 1500 * 1024 // 5000
    raised = int((1500 + 3500 * source / (source + 35e3)) * 1024 / 5000)
    assert run.finish().u16("result") == [raised, own, raised, own]


HOLD = """
volatile uint8_t go; volatile uint16_t result;
int main(void) {
    DDRB = 1; ADMUX = 0x40; ADCSRA = _BV(ADEN) | _BV(ADSC) | 7;
    while (ADCSRA & _BV(ADSC));
    go = 0; PORTB = 2;
    while (!go);
    ADCSRA |= _BV(ADSC); PORTB = 1;
    while (ADCSRA & _BV(ADSC));
    result = ADC;
    DONE();
}
"""


def converted(program: MakeProgram, wait: int) -> int:
    """The result when the input goes from 1000 mV to 4000 mV so many cycles after the start of a conversion."""
    run = program(HOLD).start()
    run.board.set_millivolts(millivolts(1000))
    run.run(10_000)
    run.set_u8("go", 1)
    while not run.board.pin("B", 0):
        run.run(1)
    run.run(wait)
    run.board.set_millivolts(millivolts(4000))
    assert run.run(10_000) == 1
    return run.u16("result")[0]


def test_the_input_is_sampled_one_and_a_half_adc_clocks_after_the_start_and_held(program: MakeProgram) -> None:
    """Prescaler 128: the sample is taken 192 cycles after a clock edge, which comes 0..128 cycles after the start."""
    old, new = 204, 819
    assert converted(program, 100) == new
    assert converted(program, 340) == old
    assert converted(program, 1500) == old


MUX = """
volatile uint16_t result[2];
int main(void) {
    ADMUX = 0x40; ADCSRA = _BV(ADEN) | _BV(ADSC) | 7; while (ADCSRA & _BV(ADSC));
    ADCSRA |= _BV(ADSC); __builtin_avr_delay_cycles(150);
    ADMUX = 0x41;
    while (ADCSRA & _BV(ADSC));
    result[0] = ADC;
    ADCSRA |= _BV(ADSC); while (ADCSRA & _BV(ADSC));
    result[1] = ADC;
    DONE();
}
"""


def test_the_channel_is_fixed_when_the_conversion_starts(program: MakeProgram) -> None:
    run = program(MUX)
    run.board.set_millivolts(millivolts(1000, 4000))
    assert run.finish().u16("result") == [204, 819]


FLAG = """
volatile uint8_t seen[4];
int main(void) {
    ADMUX = 0x40; ADCSRA = _BV(ADEN) | _BV(ADSC) | 5; while (ADCSRA & _BV(ADSC));
    seen[0] = ADCSRA; ADCSRA = _BV(ADEN) | 5; seen[1] = ADCSRA;
    (void)ADC; seen[2] = ADCSRA;
    ADCSRA = _BV(ADEN) | _BV(ADIF) | 5; seen[3] = ADCSRA;
    DONE();
}
"""


def test_adif_is_cleared_by_writing_one_and_by_nothing_else(program: MakeProgram) -> None:
    assert [bool(value & 0x10) for value in program(FLAG).finish().u8("seen")] == [True, True, True, False]


LOCK = """
volatile uint8_t low, high, low_after, high_after, ready, go;
int main(void) {
    ADMUX = 0x40; ADCSRB = 0; ADCSRA = _BV(ADEN) | _BV(ADSC) | _BV(ADATE) | 4;
    __builtin_avr_delay_cycles(1000);
    low = ADCL; ready = 1;
    while (!go);
    high = ADCH; __builtin_avr_delay_cycles(1000); low_after = ADCL; high_after = ADCH;
    DONE();
}
"""


def test_reading_adcl_locks_the_result_until_adch_is_read(program: MakeProgram) -> None:
    run = program(LOCK).start()
    run.board.set_millivolts(millivolts(5000))
    run.run(5000)
    assert run.u8("ready") == [1]
    run.board.set_millivolts(millivolts(0))
    run.run(5000)
    run.set_u8("go", 1)
    assert run.run(5000) == 1
    assert (run.u8("high")[0] << 8 | run.u8("low")[0]) == 1023
    assert (run.u8("high_after")[0] << 8 | run.u8("low_after")[0]) == 0
