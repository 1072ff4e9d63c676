"""How much faster than real time the bench is, with the real firmware following at 1 kHz and sending every sample."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from typing import Any

from greywhale.board.device import Device
from greywhale.board.record import record
from greywhale.cli.story import BenchProcess
from greywhale.files.leader import save_leader
from greywhale.motion import human_reaches
from greywhale.protocol import schema
from greywhale.protocol.frames import encode_frame
from greywhale_sim.assemble import BenchOptions, build_bench
from greywhale_sim.wiring import BOARDS
from tools.benchmarks.figure import Figure

REACH = 20.0
PIECE_S = 1.0
PIECES = 12
RECORD_S = 15.0


def run() -> list[Figure]:
    figures = []
    for board, wiring in BOARDS.items():
        speed = lock_step(board)
        figures.append(Figure(f"bench, {wiring.title}, one core", speed, "x real", ">= 20", speed >= REACH))
    speed = through_the_port()
    figures.append(Figure("bench, Mega, with a host recording every tick", speed, "x real", "", None))
    return figures


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
