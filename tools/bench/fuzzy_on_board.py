"""Calls the compiled controller of a real firmware image on the simulated board: its bits and its exact cycles.

Called are the functions without the saving of registers that C wants: the inference where the control period calls it
(fuzzy_pdi_infer 42 cycles more), the control period where the tick may call it (fuzzy_pdi_step 73 cycles more).
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

from greywhale.fuzzy.settings import JointSettings
from greywhale.link.schema import Refusal
from greywhale_sim._board import Board
from greywhale_sim.symbols import read_symbols

BUILD = Path(__file__).parents[2] / "firmware/.pio/build"
IMAGES = {"atmega2560": BUILD / "megaatmega2560/firmware.elf", "atmega328p": BUILD / "nanoatmega328/firmware.elf"}

COMPILE = "_ZN9fuzzy_pdi7compileERKNS_8SettingsEhRNS_12CoefficientsE"
SETTINGS = struct.Struct("<8h3IH")
STATE = struct.Struct("<iHh?")
SIDE_SIZE = 9
COEFFICIENTS_SIZE = 4 * SIDE_SIZE + 6
CHANGE_SIDES = 2 * SIDE_SIZE
# Scratch memory. Only powered, the board has not run an instruction: no variables, no watchdog, the stack at the end.
SETTINGS_AT, COEFFICIENTS_AT, STATE_AT = 0x0600, 0x0640, 0x0680
LIMIT = 200_000


@dataclass(frozen=True)
class Inferred:
    u: int
    no_rule: bool
    cycles: int


@dataclass(frozen=True)
class Stepped:
    u_fuzzy: int
    volts_mv: int
    saturated: bool
    no_rule: bool
    integral: int  # 2^-31 mV
    cycles: int


class FuzzyOnBoard:
    """One joint's controller in the memory of a board that runs nothing else meanwhile."""

    def __init__(self, chip: str = "atmega2560", elf: Path | None = None) -> None:
        image = elf or IMAGES[chip]
        symbols = read_symbols(image)
        self._compile, self._infer, self._step = (
            symbols[name].address for name in (COMPILE, "fuzzy_pdi_infer_bare", "fuzzy_pdi_step_bare")
        )
        self._board = Board(chip)
        self._board.load_elf(str(image))
        self._board.power_on(1)
        self._board.poke(1, b"\0")  # the register compiled code takes for zero

    def _registers(self, first: int, *words: int) -> None:
        """16-bit arguments, the first in r25:r24 and each next one two registers below."""
        packed = b"".join(struct.pack("<H", word & 0xFFFF) for word in reversed(words))
        self._board.poke(first + 2 - len(packed), packed)

    def compile(self, settings: JointSettings, period_ms: int) -> tuple[Refusal, int]:
        """Derives the coefficients on the board; the refusal and its cycles."""
        self._board.poke(SETTINGS_AT, SETTINGS.pack(*settings.as_tuple()))
        self._registers(24, SETTINGS_AT, period_ms, COEFFICIENTS_AT)
        cycles = self._board.call(self._compile, LIMIT)
        return Refusal(self._board.peek(24)[0]), cycles

    def infer(self, e: int, ce: int) -> Inferred:
        """u_fuzzy in q15 for errors in 1/4096 rad."""
        sides = [COEFFICIENTS_AT + SIDE_SIZE * (e < 0), COEFFICIENTS_AT + CHANGE_SIDES + SIDE_SIZE * (ce < 0)]
        self._registers(24, sides[0], abs(e), sides[1], abs(ce), (e < 0) == (ce < 0))
        cycles = self._board.call(self._infer, LIMIT)
        size, flip, no_rule = struct.unpack("<H??", self._board.peek(22, 4))
        return Inferred(-size if (e < 0) != flip else size, no_rule, cycles)

    def set_state(self, integral: int, previous: int | None) -> None:
        """What step() remembers: the integral in 2^-31 mV and the last error."""
        self._board.poke(STATE_AT, STATE.pack(integral >> 16, integral & 0xFFFF, previous or 0, previous is not None))

    def step(self, leader: int, follower: int, limit_mv: int) -> Stepped:
        self._registers(24, COEFFICIENTS_AT, STATE_AT, leader, follower, limit_mv)
        cycles = self._board.call(self._step, LIMIT)
        u_fuzzy, volts, saturated, no_rule = struct.unpack("<hh??", self._board.peek(18, 6))
        whole, fraction, _, _ = STATE.unpack(self._board.peek(STATE_AT, STATE.size))
        return Stepped(u_fuzzy, volts, saturated, no_rule, (whole << 16) + fraction, cycles)
