"""A generated header, compiled by the set-up's avr-gcc and called on the simulated board: bits and cycles."""

from __future__ import annotations

import re
import struct
import subprocess
from pathlib import Path

from greywhale._native import Board
from greywhale_sim.programs import load_elf
from greywhale_sim.symbols import read_symbols
from tools import avr_tool

LIMIT = 200_000  # cycles
PROGRAM = """
#include "{header}"
extern "C" __attribute__((noinline, used)) int16_t law_u(int16_t e, int16_t ce) {{ return {space}::u(e, ce); }}
extern "C" __attribute__((noinline, used)) uint8_t law_self_test() {{ return {space}::self_test(); }}
int main() {{ return 0; }}
"""
# As Arduino's own core compiles a sketch.
FLAGS = ("-std=gnu++11", "-Os", "-Wall", "-Wextra", "-Werror")


class HeaderOnBoard:
    """One header's law in the memory of a board that runs nothing else meanwhile."""

    def __init__(self, header: Path, chip: str = "atmega328p") -> None:
        elf = header.with_suffix(".elf")
        found = re.search(r"^namespace (\w+)", header.read_text(), re.MULTILINE)
        assert found is not None
        program = PROGRAM.format(header=header, space=found[1])
        command = [avr_tool("avr-g++"), *FLAGS, f"-mmcu={chip}", "-x", "c++", "-", "-o", str(elf)]
        subprocess.run(command, input=program, text=True, check=True)
        symbols = read_symbols(elf)
        self._u, self._self_test = (symbols[name].address for name in ("law_u", "law_self_test"))
        self._board = Board(chip)
        load_elf(self._board, elf)
        self._board.power_on(1)
        self._board.poke(1, b"\0")  # the register compiled code takes for zero

    def u(self, e: int, ce: int) -> tuple[int, int]:
        """The answer and the cycles, RET included."""
        self._board.poke(22, struct.pack("<hh", ce, e))
        cycles = self._board.call(self._u, LIMIT)
        (answer,) = struct.unpack("<h", self._board.peek(24, 2))
        return answer, cycles

    def self_test(self) -> int:
        """The header's own: 0 where every vector gives its answer."""
        self._board.call(self._self_test, 100 * LIMIT)
        return int(self._board.peek(24)[0])
