"""Programs made up by csmith end alike on our board, in avr8js and in simavr: the same cycles, the same memory.

GREYWHALE_PROGRAMS=130 tries so many, each by two levels of optimisation for both chips; docs/board.md has the result.
"""

from __future__ import annotations

import ctypes
import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

from greywhale._native import Board
from greywhale_sim.programs import load_hex
from tests.oracles import simavr_board
from tests.oracles.second_simulator import NODE, SCRIPTS
from tools.oracles.random_programs import LEVELS, RAM, RandomProgram, make_program

SEEDS = range(1, 1 + int(os.environ.get("GREYWHALE_PROGRAMS", "4")))
LIMIT = 3_000_000  # cycles; those that take longer are compared there
SREG, HALF_CARRY = 0x5F, 0x20
ENDED = 1


@pytest.fixture(scope="module")
def simavr() -> ctypes.CDLL:
    return simavr_board.build()


def made(chip: str, folder: Path) -> list[RandomProgram]:
    programs = [make_program(seed, chip, level, folder) for seed in SEEDS for level in LEVELS]
    return [program for program in programs if program is not None]


def run(board: Any, program: RandomProgram) -> tuple[int, bytes]:
    """The cycles until the SLEEP, or to the limit, and the data space with SREG in it; all memory was zero before."""
    first, end = RAM[program.chip]
    load_hex(board, program.hex)
    board.power_on(1)
    board.poke(0, bytes(32))
    board.poke(first, bytes(end - first))
    ended = board.run_until(LIMIT) == ENDED
    return board.cycle - ended, board.peek(0, end)


def run_avr8js(programs: list[RandomProgram], chip: str) -> list[tuple[int, bytes]]:
    command = ["node", str(SCRIPTS / "program.js"), chip, str(LIMIT), *(str(one.hex) for one in programs)]
    lines = subprocess.run(command, env=NODE, check=True, capture_output=True, text=True).stdout.splitlines()
    return [(found["cycles"], bytes.fromhex(found["data"])) for found in map(json.loads, lines)]


def without_half_carry(data: bytes, chip: str) -> tuple[bytes, int, bytes]:
    """Working registers, SREG and RAM, without the half carry and without R0, where a prologue leaves SREG.

    avr8js takes the half carry from bit 0 (its instruction.ts); the manual has it from bit 3 (SUBI, for one).
    """
    return data[1:32], data[SREG] & ~HALF_CARRY, data[RAM[chip][0] :]


@pytest.mark.parametrize("chip", RAM)
def test_random_programs_take_the_same_cycles_and_leave_the_same_memory(
    simavr: ctypes.CDLL, tmp_path: Path, chip: str
) -> None:
    programs = made(chip, tmp_path)
    assert len(programs) > len(SEEDS)
    for program, theirs in zip(programs, run_avr8js(programs, chip), strict=True):
        cycles, data = run(Board(chip), program)
        assert (cycles, *without_half_carry(data, chip)) == (theirs[0], *without_half_carry(theirs[1], chip)), program
        assert (cycles, data) == run(simavr_board.SimavrBoard(simavr, chip), program), program
