"""How fast the bench runs: the real firmware following at 1 kHz and sending every sample; board and arm alone."""

from __future__ import annotations

import tempfile
import time
import timeit
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.arm import Arm, Potentiometers
from greywhale.board.device import Device
from greywhale.board.record import record
from greywhale.cli.story import BenchProcess
from greywhale.files.arm import default_arm
from greywhale.files.leader import save_leader
from greywhale.motion import human_reaches
from greywhale.protocol import schema
from greywhale.protocol.frames import encode_frame
from greywhale_sim.assemble import BenchOptions, build_bench
from greywhale_sim.bench import CLOCK_HZ, SLICE_CYCLES, SLICE_S
from greywhale_sim.board_with_image import BoardWithImage
from greywhale_sim.wiring import BOARDS
from tools.benchmarks.figure import Figure, at_least, at_most

REACH = 20.0
PIECE_S = 1.0
PIECES = 12
RECORD_S = 15.0
ALONE_S = 2
CALLS, REPEATS = 20_000, 5


def run() -> list[Figure]:
    figures = []
    for board, wiring in BOARDS.items():
        speed = lock_step(board)
        figures.append(at_least(f"bench, {wiring.title}, one core", speed, "x real", REACH))
    figures.append(Figure("bench, Mega, with a host recording every tick", through_the_port(), "x real"))
    for board in BOARDS:
        figures += board_alone(board)
    return figures + arm_alone()


def lock_step(board: str) -> float:
    """Board, arm, potentiometers and leader, by the time of the processor core: other programs do not count."""
    bench = build_bench(BenchOptions(board=board))
    avr: Any = bench.board
    bench.run(2.0)  # bootloader and start of the firmware
    for request in (schema.TelemetryRequest(1), schema.EnableRequest(0)):
        avr.uart_send(encode_frame(request.TYPE, 1, request.pack()))
        bench.run(0.1)
    bench.run(1.5)
    if not bench.motors_enabled:
        raise RuntimeError("the firmware on the bench did not start to follow")
    best = 0.0
    for _ in range(PIECES):
        started = time.process_time()
        bench.run(PIECE_S)
        avr.uart_receive()
        best = max(best, PIECE_S / (time.process_time() - started))
    return best


def through_the_port() -> float:
    """The same behind its serial port, with the host's own recording at the other end, on average."""
    with tempfile.TemporaryDirectory() as folder:
        leader = Path(folder) / "leader.csv"
        save_leader(leader, human_reaches(1, RECORD_S))
        with BenchProcess("--speed", "max", "--leader", str(leader)) as bench, Device(bench.port) as device:
            started = time.perf_counter()
            record(device, Path(folder) / "log.csv", RECORD_S, enable=True)
            return (RECORD_S + 1.0) / (time.perf_counter() - started)


def board_alone(name: str) -> list[Figure]:
    """With the motors off, in the slices of the bench."""
    board, volts = BoardWithImage(name).board, np.full(8, 2500.0)
    for bit in range(8):
        board.add_pin_output("B", bit)

    def simulate() -> None:
        for until in range(board.cycle, board.cycle + ALONE_S * CLOCK_HZ, SLICE_CYCLES):
            board.run_until(until)
            board.set_millivolts(volts)
            board.outputs()
            board.uart_receive()

    def factor(reference: bool) -> float:
        board.use_reference_decoder(reference)
        return ALONE_S / min(timeit.repeat(simulate, number=1, repeat=REPEATS))

    fast = factor(reference=False)
    busy = 100 * (1 - board.stats().sleep_cycles / board.cycle)
    return [
        at_least(f"{name} alone, motors off", fast, "x real", REACH),
        Figure(f"{name} alone, with simavr's own decoder", factor(reference=True), "x real"),
        Figure(f"{name} alone, CPU busy", busy, "%"),
    ]


def arm_alone() -> list[Figure]:
    arm, pots = Arm(default_arm()), Potentiometers(default_arm().follower_pots)
    volts, out = np.array([4.0, 1.0, -2.0, 3.0]), np.zeros(4)

    def microseconds(call: object, inner: int = 1) -> float:
        best = min(timeit.repeat(call, number=CALLS // inner, repeat=REPEATS))  # type: ignore[arg-type]
        return best / CALLS * 1e6

    reused = microseconds(lambda: arm.step(volts, SLICE_S, out))
    return [
        at_most("arm, one 250 us step from Python", reused, "us", 3),
        Figure("arm, one 250 us step inside C++", microseconds(lambda: arm.step(volts, 100 * SLICE_S), 100), "us"),
        Figure("four potentiometers", microseconds(lambda: pots.millivolts(out, out)), "us"),
    ]
