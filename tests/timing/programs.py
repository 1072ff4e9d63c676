"""Small AVR programs made for a test: assembled, read back, and run on the simulated board."""

from __future__ import annotations

import subprocess
from pathlib import Path

from greywhale_sim._board import Board
from greywhale_sim.symbols import read_symbols
from tools.timing.bound import Timing
from tools.timing.cycles import Chip
from tools.timing.facts import Facts
from tools.timing.listing import Program, read_program


class Assembled:
    """A function `work` in assembly; r24 is its argument."""

    def __init__(self, folder: Path, body: str, chip: Chip, also: str = "") -> None:
        source, self.elf, self.chip = folder / "program.S", folder / "program.elf", chip
        source.write_text(
            f".global main\nmain: rjmp main\n{also}\n.global work\n.type work, @function\nwork:\n{body}\n"
        )
        self._compile(source)

    def _compile(self, source: Path) -> None:
        mcu = f"-mmcu={self.chip.name.lower()}"
        subprocess.run(["avr-gcc", mcu, "-nostartfiles", str(source), "-o", str(self.elf)], check=True)

    @property
    def program(self) -> Program:
        return read_program(self.elf)

    def bound(self, *times: int) -> int:
        """With these bounds for the loops of `work`."""
        program = self.program
        return Timing(program, self.chip, Facts({"work": list(times)})).of(program.entry("work")).cycles

    def measured(self, argument: int) -> int:
        board = Board(self.chip.name.lower())
        board.load_elf(str(self.elf))
        board.power_on(1)
        board.poke(24, bytes([argument]))
        return board.call(read_symbols(self.elf)["work"].address, 100_000)
