"""The Arduino bootloaders that Debian ships program the simulated flash, over STK500. The real avrdude does so in the
end-to-end tests.
"""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from greywhale_sim._board import Board
from tests.simulated_board.avr import Compile, MakeProgram
from tests.simulated_board.stk500 import Version1, Version2

BOOTLOADERS = Path("/usr/share/arduino/hardware/arduino/avr/bootloaders")
MEGA_HEX = BOOTLOADERS / "stk500v2" / "stk500boot_v2_mega2560.hex"
NANO_HEX = BOOTLOADERS / "atmega" / "ATmegaBOOT_168_atmega328.hex"  # the Nano's "old bootloader"
CYCLES_PER_MS = 16_000


def board_with(chip: str, bootloader: Path) -> Board:
    board = Board(chip)
    board.load_hex(str(bootloader), bootloader=True)
    board.power_on()
    return board


CASES = [
    ("atmega2560", MEGA_HEX, 115200, Version2, b"\x1e\x98\x01"),
    ("atmega328p", NANO_HEX, 57600, Version1, b"\x1e\x95\x0f"),
]


@pytest.mark.parametrize(("chip", "bootloader", "baud", "version", "signature"), CASES, ids=["mega", "nano"])
def test_a_bootloader_writes_and_reads_back_pages_and_starts_the_program(
    compile_avr: Compile, chip: str, bootloader: Path, baud: int, version: type[Version1 | Version2], signature: bytes
) -> None:
    board = board_with(chip, bootloader)
    board.reset()
    board.run_until(board.cycle + 100 * CYCLES_PER_MS)
    assert board.in_bootloader
    assert board.baud == pytest.approx(baud, rel=0.04)
    before = board.flash()
    programmer = version(board)
    assert programmer.signature() == signature

    plain = Board(chip)
    plain.load_elf(str(compile_avr("int main(void) { DDRB = 2; PORTB = 2; for (;;); }", chip)))
    program = plain.flash().rstrip(b"\xff")
    noise = random.Random(5).randbytes(5 * programmer.PAGE)
    image = program + b"\xff" * (-len(program) % programmer.PAGE) + noise
    for start in range(0, len(image), programmer.PAGE):
        page = image[start : start + programmer.PAGE]
        programmer.write_page(start, page)
        assert programmer.read_page(start, len(page)) == page
    assert board.flash() == image + before[len(image) :]
    assert board.stats().flash_pages >= 2 * len(image) // programmer.PAGE  # erased and written

    programmer.leave()
    board.run_until(board.cycle + 3000 * CYCLES_PER_MS)
    assert not board.in_bootloader
    assert board.pin("B", 1)


def test_the_bootloader_cannot_overwrite_itself() -> None:
    board = board_with("atmega328p", NANO_HEX)
    board.run_until(board.cycle + 50 * CYCLES_PER_MS)
    before = board.flash()
    Version1(board).write_page(0x7E00, bytes(128))
    assert board.flash() == before


def test_a_bootloader_too_large_for_the_chip_is_refused() -> None:
    """Debian's build of optiboot is 20 bytes longer than its 512-byte boot section; no chip would take it."""
    oversize = BOOTLOADERS / "optiboot" / "optiboot_atmega328.hex"
    with pytest.raises(ValueError, match="up to address 0x8013, but the ATmega328P has 32 KB of flash"):
        Board("atmega328p").load_hex(str(oversize), bootloader=True)


def test_writing_a_page_takes_the_time_of_the_chip() -> None:
    board = board_with("atmega2560", MEGA_HEX)
    board.run_until(board.cycle + 100 * CYCLES_PER_MS)
    programmer = Version2(board)
    start = board.cycle
    programmer.write_page(0, bytes(256))
    line_ms = (256 + 10 + 6 + 16 + 8 + 8) * 10 / 115.2
    assert board.cycle - start >= (line_ms + 8) * CYCLES_PER_MS  # 4 ms to erase, 4 ms to write


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
