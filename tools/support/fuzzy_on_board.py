"""Calls the compiled controller of a real firmware image on the simulated board: its bits and its exact cycles.

Bits are those of fuzzy_pdi_step_error, as C++ calls it. Cycles are those of fuzzy_pdi_step_bare, as the tick calls it,
RET included, and of the inference, which is a stretch of it.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

from greywhale._native import Board
from greywhale.fuzzy.settings import MOST_CE_TICKS, JointSettings
from greywhale.protocol.schema import Refusal
from greywhale_sim.programs import load_elf
from greywhale_sim.symbols import read_symbols
from tools import BUILT_FIRMWARE

IMAGES = {
    "atmega2560": BUILT_FIRMWARE / "megaatmega2560/firmware.elf",
    "atmega328p": BUILT_FIRMWARE / "nanoatmega328/firmware.elf",
}

COMPILE = "_ZN9fuzzy_pdi7compileERKNS_8SettingsEhRNS_12CoefficientsE"
SETTINGS = struct.Struct("<8h3IHB")
STATE = struct.Struct(f"<iHBB{MOST_CE_TICKS}h")
SIDE_SIZE = 9
COEFFICIENTS_SIZE = 4 * SIDE_SIZE + 7
# Scratch memory. Only powered, the board has not run an instruction: no variables, no watchdog, the stack at the end.
SETTINGS_AT, JOINT_AT = 0x0600, 0x0640
STATE_AT = JOINT_AT + COEFFICIENTS_SIZE
LIMIT = 200_000
LEAST_INFERENCE = 120  # cycles that it takes in any case


@dataclass(frozen=True)
class Stepped:
    u_fuzzy: int
    volts_mv: int
    saturated: bool
    no_rule: bool
    integral: int  # 2^-31 mV


class FuzzyOnBoard:
    """One joint's controller in the memory of a board that runs nothing else meanwhile."""

    def __init__(self, chip: str = "atmega2560", elf: Path | None = None) -> None:
        image = elf or IMAGES[chip]
        symbols = read_symbols(image)
        self._compile, self._step, self._bare, self._inference, self._inferred = (
            symbols[name].address
            for name in (
                COMPILE,
                "fuzzy_pdi_step_error",
                "fuzzy_pdi_step_bare",
                "fuzzy_pdi_inference",
                "fuzzy_pdi_inferred",
            )
        )
        self._board = Board(chip)
        load_elf(self._board, image)
        self._board.power_on(1)
        self._board.poke(1, b"\0")  # the register compiled code takes for zero

    def _registers(self, first: int, *words: int) -> None:
        """16-bit arguments, the first in r25:r24 and each next one two registers below."""
        packed = b"".join(struct.pack("<H", word & 0xFFFF) for word in reversed(words))
        self._board.poke(first + 2 - len(packed), packed)

    def compile(self, settings: JointSettings, period_ms: int) -> tuple[Refusal, int]:
        """Derives the coefficients on the board; the refusal and its cycles."""
        self._ce_ticks = settings.ce_ticks
        self._board.poke(SETTINGS_AT, SETTINGS.pack(*settings.as_tuple()))
        self._registers(24, SETTINGS_AT, period_ms, JOINT_AT)
        cycles = self._board.call(self._compile, LIMIT)
        return Refusal(self._board.peek(24)[0]), cycles

    def set_state(self, integral: int, previous: int | None) -> None:
        """Set step()'s memory: the integral in 2^-31 mV and the error of all periods before, None at the start."""
        until_change = self._ce_ticks if previous is None else 0
        errors = [previous or 0] * MOST_CE_TICKS
        self._board.poke(STATE_AT, STATE.pack(integral >> 16, integral & 0xFFFF, until_change, 0, *errors))

    def step(self, error: int, limit_mv: int) -> Stepped:
        """One control period, as C++ calls it."""
        self._registers(24, JOINT_AT, error, limit_mv)
        self._board.call(self._step, LIMIT)
        u_fuzzy, volts, saturated, no_rule = struct.unpack("<hh??", self._board.peek(18, 6))
        whole, fraction, *_ = STATE.unpack(self._board.peek(STATE_AT, STATE.size))
        return Stepped(u_fuzzy, volts, saturated, no_rule, (whole << 16) + fraction)

    def _bare_arguments(self, error: int, limit_mv: int) -> None:
        self._board.poke(4, struct.pack("<H", limit_mv))
        self._board.poke(24, struct.pack("<h", error))
        self._board.poke(30, struct.pack("<H", JOINT_AT))

    def period_cycles(self, error: int, limit_mv: int) -> int:
        """Of one control period, as the tick calls it."""
        self._bare_arguments(error, limit_mv)
        return self._board.call(self._bare, LIMIT)

    def inference_cycles(self, error: int) -> int:
        """Of memberships, rules and defuzzification for this error and its change."""
        self._bare_arguments(error, 0)
        board = self._board
        board.pc = self._bare
        self._run_to(self._inference)
        start = board.cycle
        board.run_until(start + LEAST_INFERENCE)
        self._run_to(self._inferred)
        return board.cycle - start

    def _run_to(self, address: int) -> None:
        end = self._board.cycle + LIMIT
        while self._board.pc != address:
            self._board.run_until(self._board.cycle + 1)
            if self._board.cycle > end:
                raise RuntimeError(f"the firmware did not reach {address:#x} within {LIMIT} cycles")
