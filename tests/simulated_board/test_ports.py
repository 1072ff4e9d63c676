"""Digital pins: what the program drives, what something outside holds, and the pull-up of a free input."""

from __future__ import annotations

import pytest

from tests.simulated_board.avr import MakeProgram, Program

READ = """
volatile uint8_t seen[4]; volatile uint8_t go;
int main(void) {
    DDRB = 0; PORTB = _BV(4); seen[0] = PINB; go = 0; while (!go);
    seen[1] = PINB; PORTB = 0; __builtin_avr_delay_cycles(4); seen[2] = PINB;
    DDRB = _BV(4); PORTB = _BV(4); __builtin_avr_delay_cycles(4); seen[3] = PINB;
    DONE();
}
"""


def run(program: MakeProgram, chip: str, high: bool | None) -> list[int]:
    """Pin B4 as the program sees it: free with its pull-up, then held, without its pull-up, and as an output."""
    started: Program = program(READ, chip).start()
    started.run(2000)
    if high is not None:
        started.board.hold_pin("B", 4, high)
    started.set_u8("go", 1)
    assert started.run(2000) == 1
    return [value >> 4 & 1 for value in started.u8("seen")]


@pytest.mark.parametrize("chip", ["atmega2560", "atmega328p"])
def test_a_pin_that_is_held_reads_its_level_unless_the_program_drives_it(program: MakeProgram, chip: str) -> None:
    assert run(program, chip, None) == [1, 1, 0, 1]
    assert run(program, chip, False) == [1, 0, 0, 1]
    assert run(program, chip, True) == [1, 1, 1, 1]


def test_a_pin_is_held_through_a_reset_until_it_is_let_go(program: MakeProgram) -> None:
    started = program(READ).start()
    started.board.hold_pin("B", 4, False)
    started.board.hold_pin("L", 7, False)
    started.board.reset()
    started.run(2000)
    assert started.u8("seen")[0] >> 4 & 1 == 0
    started.board.let_pin_go("B", 4)
    started.board.reset()
    started.run(2000)
    assert started.u8("seen")[0] >> 4 & 1 == 1
