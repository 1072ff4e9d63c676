"""USART0: time on the line, buffers and overrun, interrupts, as the data sheets have them."""

from __future__ import annotations

from itertools import pairwise

import pytest

from tests.simulated_board.avr import MakeProgram

CHIPS = ["atmega2560", "atmega328p"]
# cycles of one byte (10 bits), UBRR, U2X
SPEEDS = [(1360, 16, 1), (160, 0, 0)]

SEND = """
int main(void) {{
    UCSR0A = {u2x} << U2X0; UBRR0 = {ubrr}; UCSR0B = _BV(TXEN0);
    for (uint8_t i = 0; i < 4; ++i) {{ while (!(UCSR0A & _BV(UDRE0))); UDR0 = 'a' + i; }}
    for (;;);
}}
"""

STAMP = """
volatile uint16_t stamp[4]; volatile uint8_t count;
ISR(USART_VECTOR) {{ stamp[count++] = TCNT1; (void)UDR0; if (count == 4) DONE(); }}
int main(void) {{
    TCCR1B = 1; UCSR0A = {u2x} << U2X0; UBRR0 = {ubrr}; UCSR0B = _BV(RXEN0) | _BV(RXCIE0);
    sei(); for (;;);
}}
"""


def receive_vector(chip: str) -> str:
    return "#define USART_VECTOR " + ("USART0_RX_vect" if chip == "atmega2560" else "USART_RX_vect") + "\n"


@pytest.mark.parametrize("chip", CHIPS)
@pytest.mark.parametrize(("cycles", "ubrr", "u2x"), SPEEDS)
def test_sent_bytes_follow_each_other_every_ten_bits(
    program: MakeProgram, chip: str, cycles: int, ubrr: int, u2x: int
) -> None:
    run = program(SEND.format(ubrr=ubrr, u2x=u2x), chip).start()
    times: list[int] = []
    while len(times) < 4:
        run.run(1)
        if run.board.uart_sent > len(times):
            times.append(run.board.cycle)
    assert run.board.uart_receive() == b"abcd"
    for earlier, later in pairwise(times):
        assert abs(later - earlier - cycles) <= 3  # seen at the end of an instruction
    assert abs(times[3] - times[0] - 3 * cycles) <= 3
    assert run.board.baud == pytest.approx(16e6 / (cycles / 10))


@pytest.mark.parametrize("chip", CHIPS)
@pytest.mark.parametrize(("cycles", "ubrr", "u2x"), SPEEDS)
def test_received_bytes_arrive_every_ten_bits(
    program: MakeProgram, chip: str, cycles: int, ubrr: int, u2x: int
) -> None:
    run = program(receive_vector(chip) + STAMP.format(ubrr=ubrr, u2x=u2x), chip).start()
    run.run(2000)
    run.board.uart_send(b"wxyz")
    assert run.board.uart_pending() == 4
    assert run.run(10 * cycles) == 1
    stamps = run.u16("stamp")
    steps = [(later - earlier) % 65536 for earlier, later in pairwise(stamps)]
    assert all(abs(step - cycles) <= 2 for step in steps), steps
    assert run.board.uart_pending() == 0


READ_LATE = """
volatile uint8_t flags[6], bytes[6], count;
int main(void) {
    UBRR0 = 0; UCSR0B = _BV(RXEN0);
    for (volatile uint16_t i = 0; i < 1000; ++i);
    while (UCSR0A & _BV(RXC0)) { flags[count] = UCSR0A & (_BV(DOR0) | _BV(FE0)); bytes[count++] = UDR0; }
    DONE();
}
"""


@pytest.mark.parametrize(("sent", "kept", "lost"), [(b"123", b"123", 0), (b"12345", b"125", 2)])
def test_three_unread_bytes_are_kept_and_an_overrun_marks_the_byte_after_it(
    program: MakeProgram, sent: bytes, kept: bytes, lost: int
) -> None:
    run = program(READ_LATE).start()
    run.board.uart_send(sent)
    assert run.run(100_000) == 1
    assert run.u8("count") == [3]
    assert bytes(run.u8("bytes")[:3]) == kept
    assert run.u8("flags")[:3] == [0, 0, 0x08 if lost else 0]
    assert run.board.stats().rx_overruns == lost


ECHO = """
ISR(USART0_RX_vect) { uint8_t c = UDR0; while (!(UCSR0A & _BV(UDRE0))); UDR0 = c; }
int main(void) { UBRR0 = 0; UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0); sleep_enable(); sei();
    for (;;) sleep_cpu(); }
"""


def test_bytes_to_a_board_without_power_are_lost(program: MakeProgram) -> None:
    run = program(ECHO)
    run.board.uart_send(b"early")
    assert run.board.uart_pending() == 0
    run.start().run(1000)
    run.board.uart_send(b"late")
    run.board.power_off()
    run.start().run(10_000)
    assert run.board.uart_receive() == b""


LEVEL = """
volatile uint8_t rounds, got;
ISR(USART0_UDRE_vect) { if (++rounds == 3) UCSR0B &= ~_BV(UDRIE0); }
ISR(USART0_RX_vect) { got = UDR0; DONE(); }
int main(void) {
    UBRR0 = 0; UCSR0B = _BV(RXEN0) | _BV(TXEN0);
    for (uint8_t i = 0; i < 200; ++i) { UCSR0B |= _BV(UDRIE0); UCSR0B &= ~_BV(UDRIE0); }
    UCSR0B |= _BV(UDRIE0); sei();
    while (rounds < 3);
    for (volatile uint16_t i = 0; i < 100; ++i);
    if (rounds != 3) for (;;);
    UCSR0B |= _BV(RXCIE0);
    for (;;);
}
"""


def test_data_register_empty_and_receive_complete_are_level_interrupts(program: MakeProgram) -> None:
    """UDRE fires while it is enabled, whatever was withdrawn before; RXC for a byte that came before RXCIE."""
    run = program(LEVEL).start()
    run.board.uart_send(b"!")
    assert run.run(200_000) == 1
    assert run.u8("rounds") == [3]
    assert bytes(run.u8("got")) == b"!"


FLAGS = """
volatile uint8_t seen[4];
int main(void) {
    UBRR0 = 0; UCSR0B = _BV(TXEN0);
    UDR0 = 'x'; seen[0] = UCSR0A; UDR0 = 'y'; seen[1] = UCSR0A;
    UDR0 = 'z';
    while (!(UCSR0A & _BV(TXC0)));
    seen[2] = UCSR0A; UCSR0A = _BV(TXC0); seen[3] = UCSR0A;
    DONE();
}
"""


def test_transmitter_holds_two_bytes_and_ignores_a_third(program: MakeProgram) -> None:
    run = program(FLAGS).finish()
    udre, txc = 0x20, 0x40
    assert [flags & (udre | txc) for flags in run.u8("seen")] == [udre, 0, udre | txc, udre]
    assert run.board.uart_receive() == b"xy"
