"""Writes of a bootloader to the simulated flash, and their time. Both boards are flashed through their bootloaders in
tests/end_to_end/test_flashing.py, and by avrdude in tests/oracles/test_avrdude.py.
"""

from __future__ import annotations

import pytest

from greywhale._native import Board
from greywhale_sim.programs import load_hex
from greywhale_sim.wiring import BOOTLOADERS
from tests.simulated_board.avr import MakeProgram
from tests.simulated_board.stk500 import Version1
from tools import ROOT

NANO_HEX = BOOTLOADERS / "nano.hex"  # the Nano's "old bootloader"
OVERSIZE = ROOT / "tests/board/flash/bootloaders/optiboot.hex"
CYCLES_PER_MS = 16_000


def nano_with_bootloader() -> Board:
    board = Board("atmega328p")
    load_hex(board, NANO_HEX, bootloader=True)
    board.power_on()
    board.run_until(board.cycle + 50 * CYCLES_PER_MS)
    return board


def test_the_bootloader_cannot_overwrite_itself() -> None:
    board = nano_with_bootloader()
    before = board.flash()
    Version1(board).write_page(0x7E00, bytes(128))
    assert board.flash() == before


def test_a_bootloader_too_large_for_the_chip_is_refused() -> None:
    """Debian's build of optiboot is 20 bytes longer than its 512-byte boot section; no chip would take it."""
    with pytest.raises(ValueError, match="up to address 0x8013, but the ATmega328P has 32 KB of flash"):
        load_hex(Board("atmega328p"), OVERSIZE, bootloader=True)


def test_writing_a_page_takes_the_time_of_the_chip() -> None:
    board = nano_with_bootloader()
    programmer, page = Version1(board), bytes(range(128))
    start = board.cycle
    programmer.write_page(0, page)
    assert board.flash()[:128] == page
    line_ms = (4 + 2 + 133 + 2) * 10 / 57.6  # address and page, each with its answer
    taken_ms = (board.cycle - start) / CYCLES_PER_MS
    assert line_ms + 8 <= taken_ms < line_ms + 16, "4 ms to erase, 4 ms to write"
    assert board.stats().flash_pages == 2  # erased and written


def test_a_program_outside_the_boot_section_cannot_write_flash(program: MakeProgram) -> None:
    source = """
    #include <avr/boot.h>
    int main(void) { boot_page_erase(0x2000); boot_page_fill(0x2000, 0); boot_page_write(0x2000); DONE(); }
    """
    run = program(source)
    before = run.board.flash()
    run.finish()
    assert run.board.flash() == before
    assert run.board.stats().flash_pages == 0
