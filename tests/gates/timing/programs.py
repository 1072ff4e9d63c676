"""Small AVR programs made for a test: assembled, read back, and run on the simulated board."""

from __future__ import annotations

import subprocess
from pathlib import Path

from greywhale._native import Board
from greywhale_sim.programs import load_elf
from greywhale_sim.symbols import read_symbols
from tools import avr_tool
from tools.gates.timing.bound import Timing
from tools.gates.timing.cycles import Chip
from tools.gates.timing.facts import Facts
from tools.gates.timing.listing import Program, read_program


class Assembled:
    """A function `work` in assembly; r24 is its argument."""

    def __init__(self, folder: Path, body: str, chip: Chip, also: str = "") -> None:
        source, self.elf, self.chip = folder / "program.S", folder / "program.elf", chip
        source.write_text(
            f".global main\nmain: rjmp main\n{also}\n.global work\n.type work, @function\nwork:\n{body}\n"
        )
        command = [avr_tool("avr-gcc"), f"-mmcu={chip.name.lower()}", "-nostartfiles", str(source), "-o", str(self.elf)]
        subprocess.run(command, check=True)

    @property
    def program(self) -> Program:
        return read_program(self.elf)

    def bound(self, *times: int) -> int:
        """With these bounds for the loops of `work`."""
        program = self.program
        return Timing(program, self.chip, Facts({"work": list(times)})).of(program.entry("work"))

    def measured(self, argument: int) -> int:
        board = Board(self.chip.name.lower())
        load_elf(board, self.elf)
        board.power_on(1)
        board.poke(1, b"\0")  # the register that compiled code takes for zero
        board.poke(24, bytes([argument]))
        return board.call(read_symbols(self.elf)["work"].address, 100_000)


class Compiled(Assembled):
    """A program from C++, with `work(uint8_t)` somewhere in it."""

    def __init__(self, folder: Path, source: str, chip: Chip) -> None:
        self.elf, self.chip = folder / "program.elf", chip
        path = folder / "program.cpp"
        path.write_text(source)
        command = [
            avr_tool("avr-g++"),
            f"-mmcu={chip.name.lower()}",
            "-O2",
            "-std=gnu++14",
            str(path),
            "-o",
            str(self.elf),
        ]
        subprocess.run(command, check=True)
