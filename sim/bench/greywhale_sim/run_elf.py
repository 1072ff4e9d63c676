"""Runs one AVR program on the simulated board and prints what it sends over USART0: for tests on the target.

    python -m greywhale_sim.run_elf PROGRAM.elf [--mcu atmega2560] [--millivolts 2500,0,...] [--limit-s 60] [--loopback]

The program ends when it sleeps with interrupts off. The exit code is then 0. It is 1 when the program crashes or the
time limit is reached, and 2 for a program or an option that makes no sense.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

import numpy as np

from greywhale._native import Board, BoardError
from greywhale_sim.programs import load_elf

CYCLES_PER_S = 16_000_000
SLICE_CYCLES = 160_000  # output appears every 10 ms of simulated time
ADC_INPUTS = 8


def parse_millivolts(text: str) -> list[float]:
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if not 1 <= len(values) <= ADC_INPUTS or not all(0 <= value <= 5000 for value in values):
        raise argparse.ArgumentTypeError(f"{text!r} is not a list of up to {ADC_INPUTS} voltages of 0 to 5000 mV")
    return values + [0.0] * (ADC_INPUTS - len(values))


def parse_arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="greywhale_sim.run_elf", description=__doc__.splitlines()[0])
    parser.add_argument("program", help="linked AVR program (.elf)")
    parser.add_argument("--mcu", default="atmega2560", choices=["atmega2560", "atmega328p"])
    parser.add_argument(
        "--millivolts", type=parse_millivolts, default="0", help="voltages at ADC0, ADC1, ... separated by commas"
    )
    parser.add_argument("--limit-s", type=float, default=60.0, help="simulated seconds to wait (default 60)")
    parser.add_argument("--loopback", action="store_true", help="a wire from TX0 to RX0")
    return parser.parse_args(arguments)


def run(program: str, mcu: str, millivolts: Sequence[float], limit_s: float, loopback: bool = False) -> int:
    """Run the program to its end, copy USART0 to standard output, and return the exit code."""
    board = Board(mcu)
    load_elf(board, program)
    board.power_on()
    board.uart_loopback = loopback
    board.set_millivolts(np.asarray(millivolts, dtype=np.float64))
    limit = int(limit_s * CYCLES_PER_S)
    state = 0
    while state == 0 and board.cycle < limit:
        state = board.run_until(min(board.cycle + SLICE_CYCLES, limit))
        sys.stdout.buffer.write(board.uart_receive())
        sys.stdout.buffer.flush()
    if state == 2:
        print(f"{program} crashed at address {board.pc:#x}: {board.crash_reason.strip()}", file=sys.stderr)
    elif state == 0:
        print(
            f"{program} did not end within {limit_s:g} s of simulated time; raise --limit-s or mend it", file=sys.stderr
        )
    return 0 if state == 1 else 1


def main(arguments: Sequence[str] | None = None) -> int:
    options = parse_arguments(arguments)
    try:
        return run(options.program, options.mcu, options.millivolts, options.limit_s, options.loopback)
    except BoardError as error:
        print(error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
