"""Measures a control tick on the simulated boards: cycles, jitter, time from pot to duty, memory with the stack."""

from __future__ import annotations

import numpy as np

from greywhale.protocol import schema
from greywhale_sim.board_with_image import CYCLES_PER_TICK, UNWATCHED, BoardWithImage, ram_of_a_life
from greywhale_sim.wiring import BOARDS
from tools.benchmarks.figure import Figure, at_most

TICKS = 250


def ticks(name: str) -> list[Figure]:
    bench = BoardWithImage(name)
    bench.apply(UNWATCHED | {"rail_counts": 0})  # the inputs jump within a tick, as if wires touched
    bench.ask(schema.EnableRequest(0))
    bench.wait(1100)
    whole, alone = [], []
    for _ in range(TICKS):
        bench.wiggle(1000)  # up to 2 rad apart, another way each tick
        both = bench.tick_cycles()
        whole.append(both[0])
        alone.append(both[1])
    worst = max(alone)
    return [
        at_most(f"{name.title()}: tick, worst of {TICKS}", worst, "cycles", 3200),
        Figure(f"{name.title()}: tick, mean", float(np.mean(alone)), "cycles"),
        Figure(f"{name.title()}: tick with its interrupts, worst", max(whole) / 16, "us"),
    ]


def jitter(name: str) -> Figure:
    """Of the tick's interrupt, which starts the first conversion itself, while telemetry and noise use the link."""
    bench = BoardWithImage(name)
    bench.ask(schema.TelemetryRequest(1))
    first = bench.next_entry()
    late = []
    for i in range(1, TICKS):
        bench.board.run_until(first + CYCLES_PER_TICK * (i - 1) + int(bench.random.integers(9_000, 15_800)))
        bench.board.uart_send(bench.random.bytes(30))
        bench.board.run_until(first + CYCLES_PER_TICK * i - 150)
        late.append(bench.next_entry() - first - CYCLES_PER_TICK * i)
    spread = (max(late) - min(late)) / 16
    return at_most(f"{name.title()}: tick jitter", spread, "us", 10)


def latency(name: str) -> list[Figure]:
    """From a step at a leader pot to the first change of the duty, over all phases of the tick."""
    bench = BoardWithImage(name)
    bench.apply(UNWATCHED)
    bench.ask(schema.EnableRequest(0))
    bench.wait(1100)
    delays = []
    for _ in range(60):
        bench.wait(40 + bench.random.uniform(0, 1))  # the low-pass has settled
        bench.millivolts[0] += 300.0 if bench.millivolts[0] < 2500 else -300.0
        bench.board.set_millivolts(bench.millivolts)
        start, duty = bench.board.cycle, bench.duty()
        while bench.duty() == duty:
            bench.board.run_until(bench.board.cycle + 16)
        delays.append((bench.board.cycle - start) / CYCLES_PER_TICK)
    mean = float(np.mean(delays))
    return [
        Figure(f"{name.title()}: leader pot to duty, mean over the phases of the tick", mean, "ms"),
        at_most(f"{name.title()}: leader pot to duty, worst phase", max(delays), "ms", 1.3),
    ]


def memory(name: str) -> Figure:
    total = ram_of_a_life(name)
    return at_most(f"{name.title()}: RAM with the deepest stack", total, "bytes", 1808)


def run() -> list[Figure]:
    figures = []
    for name in BOARDS:
        figures += [*ticks(name), jitter(name), *latency(name), memory(name)]
    return figures
