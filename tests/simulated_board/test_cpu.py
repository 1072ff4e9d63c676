"""The CPU at the end of the flash, and with the instructions it skips. Every instruction is compared with
another simulator's in tests/oracles/test_simavr_cpu.py.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale._native import Board
from greywhale_sim.programs import load_hex
from tests.board.flash.hex_files import hex_text
from tests.simulated_board.avr import MakeProgram

FLASH_BYTES = {"atmega2560": 0x40000, "atmega328p": 0x8000}
NOP, JMP_0, LDS_R0, SBRC_R0_0 = b"\0\0", b"\x0c\x94\0\0", b"\x00\x90", b"\x00\xfc"


@pytest.mark.parametrize(
    ("last", "first", "then"),
    [(NOP, NOP, 0), (LDS_R0, b"\x00\x02", 2), (SBRC_R0_0, NOP, 2), (SBRC_R0_0, JMP_0, 4)],
    ids=["a word", "two words", "a skip over one word", "a skip over two"],
)
@pytest.mark.parametrize("chip", ["atmega2560", "atmega328p"])
def test_behind_the_end_of_the_flash_comes_its_beginning(
    tmp_path: Path, chip: str, last: bytes, first: bytes, then: int
) -> None:
    image = tmp_path / "full.hex"
    image.write_text(hex_text(first.ljust(FLASH_BYTES[chip] - len(last), b"\0") + last))
    board = Board(chip)
    load_hex(board, image)
    board.power_on(1)
    board.poke(0, b"\0")
    board.pc = FLASH_BYTES[chip] - len(last)
    board.run_until(board.cycle + 1)
    assert board.pc == then
    board.run_until(board.cycle + 1)
    assert board.pc == then + len(NOP)


SKIP_WORD = """
volatile uint8_t low;
int main(void) {
    __asm__ volatile("ldi r24, 1\\n ldi r25, 0\\n sbrs r24, 0\\n adiw r24, 15\\n inc r24\\n sts low, r24");
    DONE();
}
"""


def test_a_skip_over_adiw_skips_one_word(program: MakeProgram) -> None:
    assert program(SKIP_WORD).finish().u8("low") == [2]
