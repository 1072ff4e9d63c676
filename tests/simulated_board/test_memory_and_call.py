"""Looking into the board: data memory, and the exact cycles of compiled functions."""

from __future__ import annotations

import pytest

from tests.simulated_board.avr import MakeProgram

FUNCTIONS = """
__attribute__((naked, used)) void only_return(void) { __asm__ volatile("ret"); }
__attribute__((naked, used)) void ten_nops(void) { __asm__ volatile(".rept 10\\n nop\\n .endr\\n ret"); }
__attribute__((noinline, used)) uint16_t add(uint16_t a, uint16_t b) { __asm__ volatile(""); return a + b; }
__attribute__((noinline, used)) void endless(void) { for (;;) __asm__ volatile(""); }
__attribute__((noinline, used)) void crash(void) { *(volatile uint8_t *)0x6000 = 1; }
volatile uint16_t ticks;
ISR(TIMER0_COMPA_vect) { ++ticks; }
int main(void) { TCCR0A = 2; OCR0A = 249; TCCR0B = 3; TIMSK0 = 2; sei(); for (;;); }
"""


@pytest.mark.parametrize(("chip", "ret"), [("atmega2560", 5), ("atmega328p", 4)])
def test_call_gives_exact_cycles_and_leaves_the_program_where_it_was(program: MakeProgram, chip: str, ret: int) -> None:
    run = program(FUNCTIONS, chip).start()
    run.run(20_000)
    board, symbols = run.board, run.symbols
    pc, stack = board.pc, board.peek(0x5D, 3)
    assert board.call(symbols["only_return"].address, 1000) == ret
    assert board.call(symbols["ten_nops"].address, 1000) == 10 + ret
    board.poke(22, (4000).to_bytes(2, "little") + (1234).to_bytes(2, "little"))
    assert board.call(symbols["add"].address, 1000) == 2 + ret
    assert int.from_bytes(board.peek(24, 2), "little") == 5234
    assert (board.pc, board.peek(0x5D, 3)) == (pc, stack)
    before = run.u16("ticks")[0]
    run.run(160_000)
    assert run.u16("ticks")[0] == before + 10


def test_a_call_that_does_not_come_back_is_an_error(program: MakeProgram) -> None:
    run = program(FUNCTIONS).start()
    with pytest.raises(ValueError, match="did not return within 5000 cycles"):
        run.board.call(run.symbols["endless"].address, 5000)
    with pytest.raises(ValueError, match=r"crashed: a write beyond the end of RAM, to 0x6000"):
        run.board.call(run.symbols["crash"].address, 5000)
    with pytest.raises(ValueError, match="no function at 0x50000"):
        run.board.call(0x50000, 5000)


def test_peek_and_poke_reach_registers_and_ram_and_nothing_else(program: MakeProgram) -> None:
    run = program("volatile uint8_t x = 5; int main(void) { sei(); for (;;); }").start()
    run.run(2000)
    assert run.u8("x") == [5]
    run.set_u8("x", 9)
    assert run.u8("x") == [9]
    assert run.board.peek(0x5F)[0] & 0x80
    assert run.board.peek(0x5D, 2) == (0x21FF - 3).to_bytes(2, "little")
    assert len(run.board.peek(0, 0x2200)) == 0x2200
    for address, count in ((0x2200, 1), (0x21FF, 2), (0xFFFFFFFF, 1)):
        with pytest.raises(ValueError, match=r"do not all exist; the ATmega2560 has 0 \.\. 0x21FF"):
            run.board.peek(address, count)
    with pytest.raises(ValueError, match="do not all exist"):
        run.board.poke(0x21FF, b"ab")
