"""How fast the simulated board runs the firmware, and what a call from Python costs."""

from __future__ import annotations

import timeit

import numpy as np

from greywhale_sim._board import Board
from tools import ROOT
from tools.benchmarks.figure import Figure

FIRMWARE = ROOT / "firmware" / ".pio" / "build"
BOARDS = {"atmega2560": "megaatmega2560", "atmega328p": "nanoatmega328"}
CYCLES_PER_S = 16_000_000
SLICE = CYCLES_PER_S // 4000  # the bench exchanges voltages and duties every 250 us
SIMULATED_S = 2
REPEATS = 3
CALLS = 50_000


def prepared(chip: str) -> Board:
    board = Board(chip)
    board.load_elf(str(FIRMWARE / BOARDS[chip] / "firmware.elf"))
    board.power_on()
    for bit in range(8):
        board.add_pin_output("B", bit)
    return board


def real_time_factor(board: Board, reference: bool) -> float:
    """Simulated seconds a second, in the slices of the bench."""
    board.use_reference_decoder(reference)
    volts = np.full(8, 2500.0)

    def simulate() -> None:
        for until in range(board.cycle, board.cycle + SIMULATED_S * CYCLES_PER_S, SLICE):
            board.run_until(until)
            board.set_millivolts(volts)
            board.outputs()
            board.uart_receive()

    return SIMULATED_S / min(timeit.repeat(simulate, number=1, repeat=REPEATS))


def run() -> list[Figure]:
    figures = []
    for chip in BOARDS:
        board = prepared(chip)
        fast = real_time_factor(board, reference=False)
        busy = 100 * (1 - board.stats().sleep_cycles / board.cycle)
        figures += [
            Figure(f"board alone, {chip}, firmware disabled", fast, "x", ">= 20 x real time", fast >= 20),
            Figure(f"  with simavr's own decoder, {chip}", real_time_factor(board, reference=True), "x"),
            Figure(f"  CPU busy, {chip}", busy, "%"),
        ]
    board, volts = prepared("atmega2560"), np.full(8, 2500.0)
    calls = {
        "run_until, nothing to do": lambda: board.run_until(0),
        "set_millivolts": lambda: board.set_millivolts(volts),
        "outputs, 8 of them": board.outputs,
        "uart_receive, empty": board.uart_receive,
    }
    for name, call in calls.items():
        cost = min(timeit.repeat(call, number=CALLS, repeat=REPEATS)) / CALLS * 1e6
        figures.append(Figure(f"board, {name}", cost, "us", "<= 1 us", cost <= 1))
    return figures
