"""The CPU of the simulated board against simavr 1.6's, instruction by instruction, from random states."""

from __future__ import annotations

import ctypes
import random
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from greywhale._native import Board
from greywhale_sim.programs import load_elf, load_hex
from tests.board.flash.hex_files import hex_text
from tests.oracles.simavr_board import SimavrBoard, build
from tests.simulated_board.avr import BUSY, PRELUDE

Boards = Callable[[str], tuple[Any, Any]]


@pytest.fixture(scope="session")
def simavr() -> ctypes.CDLL:
    return build()


@pytest.fixture
def both(simavr: ctypes.CDLL) -> Boards:
    """Of a chip: our board, and the same with simavr's CPU."""
    return lambda chip: (Board(chip), SimavrBoard(simavr, chip))


# Every instruction of the two chips; letters stand for operand bits.
COMMON = """
0000000000000000 00000001xxxxxxxx 00000010xxxxxxxx 00000011xxxxxxxx 000001xxxxxxxxxx 000010xxxxxxxxxx
000011xxxxxxxxxx 000100xxxxxxxxxx 000101xxxxxxxxxx 000110xxxxxxxxxx 000111xxxxxxxxxx 001000xxxxxxxxxx
001001xxxxxxxxxx 001010xxxxxxxxxx 001011xxxxxxxxxx 0011xxxxxxxxxxxx 0100xxxxxxxxxxxx 0101xxxxxxxxxxxx
0110xxxxxxxxxxxx 0111xxxxxxxxxxxx 10x0xx0xxxxxxxxx 10x0xx1xxxxxxxxx 1001000xxxxx0001 1001000xxxxx0010
1001000xxxxx1001 1001000xxxxx1010 1001000xxxxx1100 1001000xxxxx1101 1001000xxxxx1110 1001001xxxxx0001
1001001xxxxx0010 1001001xxxxx1001 1001001xxxxx1010 1001001xxxxx1100 1001001xxxxx1101 1001001xxxxx1110
1001000xxxxx1111 1001001xxxxx1111 1001000xxxxx0100 1001000xxxxx0101 1001010xxxxx0000 1001010xxxxx0001
1001010xxxxx0010 1001010xxxxx0011 1001010xxxxx0101 1001010xxxxx0110 1001010xxxxx0111 1001010xxxxx1010
100101000xxx1000 100101001xxx1000 1001010000001001 1001010100001001 1001010100001000 1001010100011000
1001010110011000 1001010110101000 1001010111001000 1001010111101000 10010110xxxxxxxx 10010111xxxxxxxx
10011000xxxxxxxx 10011001xxxxxxxx 10011010xxxxxxxx 10011011xxxxxxxx 100111xxxxxxxxxx 10110xxxxxxxxxxx
10111xxxxxxxxxxx 1100xxxxxxxxxxxx 1101xxxxxxxxxxxx 1110xxxxxxxxxxxx 111100xxxxxxxxxx 111101xxxxxxxxxx
1111100xxxxx0xxx 1111101xxxxx0xxx 1111110xxxxx0xxx 1111111xxxxx0xxx
"""
WIDE = ["1001010000011001", "1001010100011001", "1001010111011000", "1001000xxxxx0110", "1001000xxxxx0111"]
MISTAKEN = ["10010110xxxxxxxx", "10010111xxxxxxxx"]  # simavr takes some ADIW and SBIW for CALL when it skips them
TWO_WORDS = ["1001000xxxxx0000", "1001001xxxxx0000", "100101000000110x", "100101000000111x"]  # LDS, STS, JMP, CALL
FLASH_BYTES = {"atmega2560": 0x40000, "atmega328p": 0x8000}
LAST_RAM = {"atmega2560": 0x21FF, "atmega328p": 0x08FF}
SPACING = 8  # bytes from one instruction under test to the next


def fill(pattern: str, dice: random.Random) -> int:
    return int("".join(dice.choice("01") if bit == "x" else bit for bit in pattern), 2)


def instruction(chip: str, dice: random.Random, pattern: str) -> list[int]:
    words = [fill(pattern, dice)]
    if pattern in TWO_WORDS:
        in_memory = pattern.startswith("100100")
        words.append(dice.randrange(0x20, LAST_RAM[chip] + 1) if in_memory else dice.randrange(0x3000))
    return words


def random_state(chip: str, dice: random.Random) -> list[tuple[int, bytes]]:
    """Registers with pointers that stay inside memory, the stack with a return address, the flags, RAMPZ and EIND."""
    pointers = b"".join(dice.randrange(0x20, LAST_RAM[chip] - 70).to_bytes(2, "little") for _ in range(3))
    registers = dice.randbytes(26) + pointers
    stack = dice.randrange(0x300, LAST_RAM[chip] - 10)
    return_address = dice.randrange(FLASH_BYTES[chip] // 2).to_bytes(3 if chip == "atmega2560" else 2, "big")
    state = [
        (stack + 1, return_address),
        (0, registers),
        (0x5D, stack.to_bytes(2, "little")),
        (0x5F, bytes([dice.randrange(256)])),
    ]
    if chip == "atmega2560":
        state.append((0x5B, bytes([dice.randrange(4), dice.randrange(2)])))
    return state


def observe(board: Any, chip: str) -> tuple[int, int, int, bytes]:
    """All there is to see."""
    return board.pc, board.cycle, board.trace_hash, board.peek(0, LAST_RAM[chip] + 1)


@pytest.mark.parametrize("chip", ["atmega2560", "atmega328p"])
@pytest.mark.parametrize("seed", range(4))
def test_every_instruction_does_what_simavr_does(both: Boards, tmp_path: Path, chip: str, seed: int) -> None:
    dice = random.Random(f"{chip} {seed}")
    patterns = COMMON.split() + TWO_WORDS + (WIDE if chip == "atmega2560" else [])
    flash = bytearray()
    tested: list[tuple[int, str]] = []
    while len(flash) < 0x6000:
        pattern = patterns[len(tested) % len(patterns)]
        tested.append((len(flash), pattern))
        words = instruction(chip, dice, pattern)
        while len(words) < SPACING // 2:  # what a skip may skip, one word or two
            words += instruction(chip, dice, dice.choice([p for p in patterns if p not in MISTAKEN]))
        flash += b"".join(word.to_bytes(2, "little") for word in words[: SPACING // 2])
    image = tmp_path / "random.hex"
    image.write_text(hex_text(bytes(flash)))

    fast, reference = both(chip)
    for board in (fast, reference):
        load_hex(board, image)
    for index, (address, pattern) in enumerate(tested):
        state = random_state(chip, dice)
        for board in (fast, reference):
            if index % 200 == 0:
                board.power_on(seed + index)
            for at, value in state:
                board.poke(at, value)
            board.pc = address
            board.run_until(board.cycle + 1)
        assert observe(fast, chip) == observe(reference, chip), f"instruction {index}, pattern {pattern}"
    assert fast.flash() == reference.flash()


# Each sets flags in a way of its own: ADC, SBC, CPC, EOR, COM, INC, ASR, ROR, ADIW, MUL, OUT SREG. PUSH keeps them.
SETS_FLAGS = """
000111xxxxxxxxxx 000010xxxxxxxxxx 000001xxxxxxxxxx 001001xxxxxxxxxx 1001010xxxxx0000 1001010xxxxx0011 1001010xxxxx0101
1001010xxxxx0111 10010110xxxxxxxx 100111xxxxxxxxxx 10111111xxxx1111
"""
IN_R16_SREG, PUSH_R16 = 0xB70F, 0x930F


@pytest.mark.parametrize("chip", ["atmega2560", "atmega328p"])
def test_a_program_reads_the_flags_that_the_instruction_before_has_set(both: Boards, tmp_path: Path, chip: str) -> None:
    dice, count = random.Random(chip), 300
    words = [w for _ in range(count) for w in (fill(dice.choice(SETS_FLAGS.split()), dice), IN_R16_SREG, PUSH_R16)]
    image = tmp_path / "flags.hex"
    image.write_text(hex_text(b"".join(word.to_bytes(2, "little") for word in words)))
    fast, reference = both(chip)
    for board in (fast, reference):
        load_hex(board, image)
        board.power_on(1)
        board.poke(0x5D, LAST_RAM[chip].to_bytes(2, "little"))
        board.run_until(board.cycle + 4 * count)
    assert observe(fast, chip) == observe(reference, chip)


@pytest.mark.parametrize("chunk", [1, 100, 50_000])
def test_a_whole_program_with_interrupts_does_what_simavr_does(both: Boards, tmp_path: Path, chunk: int) -> None:
    path = tmp_path / "busy.elf"
    command = ["avr-gcc", "-mmcu=atmega2560", "-Os", "-std=gnu11", "-x", "c", "-o", str(path), "-"]
    subprocess.run(command, input=PRELUDE + BUSY, text=True, check=True)
    boards = both("atmega2560")
    for board in boards:
        load_elf(board, path)
        board.power_on(9)
    for _ in range(2_000_000 // chunk if chunk > 1 else 100_000):
        for board in boards:
            board.run_until(board.cycle + chunk)
        assert boards[0].cycle == boards[1].cycle
    assert observe(boards[0], "atmega2560") == observe(boards[1], "atmega2560")
    assert boards[0].uart_receive() == boards[1].uart_receive()
