"""Program files: what is loaded where, and one sentence for everything that can be wrong with one."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path

import pytest

from greywhale._native import Board, BoardError
from greywhale_sim.programs import load_elf, load_hex
from greywhale_sim.symbols import read_symbols
from tests.board.flash.hex_files import record
from tests.simulated_board.avr import Compile, MakeProgram

END = ":00000001FF\n"


def write(folder: Path, text: str) -> str:
    path = folder / "firmware.hex"
    path.write_text(text)
    return str(path)


def test_hex_data_goes_where_its_base_address_says(tmp_path: Path) -> None:
    board = Board("atmega2560")
    text = record(0, 0x10, b"low") + record(2, 0, b"\x10\x00") + record(0, 0x20, b"segment") + record(4, 0, b"\x00\x03")
    load_hex(board, write(tmp_path, text + record(0, 0x30, b"linear") + END))
    flash = board.flash()
    assert len(flash) == 256 * 1024
    assert flash[0x10:0x13] == b"low"
    assert flash[0x10020:0x10027] == b"segment"
    assert flash[0x30030:0x30036] == b"linear"
    assert flash.count(b"\xff") == len(flash) - 16
    board.erase_flash()
    assert board.flash() == b"\xff" * len(flash)


def test_a_program_without_room_is_one_sentence_and_nothing_of_it_is_written(tmp_path: Path) -> None:
    """Other faults of a HEX file are in tests/board/flash/test_images.py."""
    board = Board("atmega328p")
    path = write(tmp_path, record(0, 0, b"abc") + record(0, 0x8000, b"abc") + END)
    with pytest.raises(BoardError, match=rf"^{path} .*up to address 0x8002, but the ATmega328P has 32 KB of flash; "):
        load_hex(board, path)
    assert board.flash() == b"\xff" * 32768


def test_an_elf_is_loaded_to_flash_and_eeprom_and_runs(program: MakeProgram) -> None:
    run = program(
        '#include <avr/eeprom.h>\n uint8_t EEMEM stored[3] = {1, 2, 3}; const char text[] = "in flash";\n'
        "volatile uint8_t data = 42, copy; int main(void) { copy = data + text[0]; DONE(); }"
    )
    assert run.board.eeprom()[:4] == b"\x01\x02\x03\xff"
    run.finish()
    assert run.u8("copy") == [(42 + ord("i")) % 256]
    assert run.symbols["main"].in_flash
    assert not run.symbols["data"].in_flash
    assert "stored" not in run.symbols


def test_a_bad_elf_is_one_sentence(compile_avr: Compile, tmp_path: Path) -> None:
    good = compile_avr("int main(void) { DONE(); }", "atmega328p").read_bytes()
    cases = {
        b"not an ELF file, although it is long enough to be one, isn't it?": "Magic number does not match",
        b"\x7fELF": "cannot be read as an ELF program",
        good[:100]: "cannot be read as an ELF program",
        good[:200]: "it ends inside a segment",
        good[:18] + b"\x3e\x00" + good[20:]: "it is no linked program for an AVR",
        good[:16] + b"\x01\x00" + good[18:]: "it is no linked program for an AVR",
    }
    path = tmp_path / "firmware.elf"
    for content, words in cases.items():
        path.write_bytes(content)
        with pytest.raises(BoardError) as error:
            load_elf(Board("atmega328p"), path)
        assert re.search(words, str(error.value))
        assert str(error.value).startswith(str(path))


def test_a_program_for_another_chip_or_without_symbols_or_missing_is_refused(
    compile_avr: Compile, tmp_path: Path
) -> None:
    nano = compile_avr("int main(void) { DONE(); }", "atmega328p")
    with pytest.raises(BoardError, match=r"built for another chip family \(avr5\), but this board's chip is avr6"):
        load_elf(Board("atmega2560"), nano)
    missing = tmp_path / "missing"
    for load in (partial(load_elf, Board("atmega328p")), read_symbols):
        with pytest.raises(BoardError, match=r"missing.* cannot be"):
            load(missing)
    with pytest.raises(BoardError, match='"atmega32u4" is not simulated; use atmega2560 or atmega328p'):
        Board("atmega32u4")
