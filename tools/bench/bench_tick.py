"""What a control tick costs on the simulated boards: cycles, jitter, time from pot to duty, memory with the stack."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from greywhale.protocol import frames, schema
from greywhale.protocol.declared import Message
from greywhale_sim._board import Board
from greywhale_sim.symbols import Symbol, read_symbols
from tools.bench.figure import Figure
from tools.bench.fuzzy_search import Random

BUILD = Path(__file__).parents[2] / "firmware/.pio/build"
CYCLES_PER_TICK = 16_000
TICKS = 250
SETS, TICKS_PER_SET = 300, 10  # for the worst tick over the parameters
PAINT = 0xA5
UNWATCHED = {"speed_limit": 0, "runaway_limit": 0, "stall_volts": 0}  # potentiometers here move as no arm does
RUNNING = "_ZN3hal12_GLOBAL__N_17runningE"  # hal's flag, set from the timer's interrupt to the end of the tick
BOARDS = {  # name: chip, environment, vector of the tick, RAM, duty output of joint 0
    "Mega": ("atmega2560", "megaatmega2560", "__vector_21", (0x200, 0x2200), (3, "A")),
    "Nano": ("atmega328p", "nanoatmega328", "__vector_14", (0x100, 0x900), (1, "A")),
}


class Bench:
    """The real image on a simulated board, with a host that only knows frames."""

    def __init__(self, name: str) -> None:
        chip, environment, vector, self.ram, self.output = BOARDS[name]
        elf = BUILD / environment / "firmware.elf"
        self.symbols = read_symbols(elf)
        self.running = self._find(RUNNING).address
        self.vector = self.symbols[vector].address
        self.random = np.random.default_rng(7)
        self.millivolts = np.full(8, 2500.0)
        self.board = Board(chip)
        self.board.load_elf(str(elf))
        self.board.power_on(1)
        self.board.set_millivolts(self.millivolts)
        self.paint()
        self.wait(60)

    def _find(self, prefix: str) -> Symbol:
        return next(symbol for name, symbol in self.symbols.items() if name.startswith(prefix))

    @property
    def statics(self) -> int:
        return max(self.symbols[name].address for name in ("__bss_end", "_end")) - self.ram[0]

    def paint(self) -> None:
        start = self.ram[0] + self.statics
        self.board.poke(start, bytes([PAINT]) * (self.ram[1] - start))

    def stack(self) -> int:
        start = self.ram[0] + self.statics
        free = self.board.peek(start, self.ram[1] - start)
        return len(free) - next(i for i, byte in enumerate(free) if byte != PAINT)

    def wait(self, ms: float) -> None:
        self.board.run_until(self.board.cycle + int(ms * CYCLES_PER_TICK))

    def ask(self, message: type[Message], payload: bytes = b"") -> bytes:
        self.board.uart_receive()
        self.board.uart_send(frames.encode_frame(message.TYPE, 1, payload))
        decoder = frames.FrameDecoder()
        for _ in range(60):
            self.wait(1)
            for frame in decoder.feed(self.board.uart_receive()):
                if frame.type == message.TYPE | 0x80:
                    return bytes(frame.payload)
        raise RuntimeError(f"the firmware did not do as asked: {message.__name__}")

    def interrupt_cycles(self) -> float:
        return sum(times.count * times.mean for times in self.board.stats().vectors.values())

    def run_to(self, cycle: int) -> None:
        self.board.run_until(cycle)

    def next_entry(self) -> int:
        """Runs to the tick's interrupt and says when that was."""
        while self.board.pc != self.vector:
            self.board.run_until(self.board.cycle + 1)
        return self.board.cycle

    def tick_cycles(self) -> tuple[int, float]:
        """Cycles from the tick's interrupt to the end of its work: with all interrupts, and the work alone."""
        entry = self.next_entry()
        before = self.interrupt_cycles()
        while not self.board.peek(self.running, 1)[0]:
            self.board.run_until(self.board.cycle + 1)
        while self.board.peek(self.running, 1)[0]:
            self.board.run_until(self.board.cycle + 1)
        whole = self.board.cycle - entry
        return whole, whole - (self.interrupt_cycles() - before)

    def wiggle(self, millivolts: float) -> None:
        self.board.set_millivolts(self.millivolts + self.random.uniform(-millivolts, millivolts, 8))


def ticks(name: str) -> list[Figure]:
    bench = Bench(name)
    apply(bench, UNWATCHED)
    bench.ask(schema.EnableRequest, struct.pack("<H", 0))
    bench.wait(1100)
    whole, alone = [], []
    for _ in range(TICKS):
        bench.wiggle(1000)  # up to 2 rad apart, another way each tick
        both = bench.tick_cycles()
        whole.append(both[0])
        alone.append(both[1])
    worst = max(alone)
    return [
        Figure(f"{name}: tick, worst of {TICKS}", worst, "cycles", "<= 3,200 cycles", worst <= 3200),
        Figure(f"{name}: tick, mean", float(np.mean(alone)), "cycles"),
        Figure(f"{name}: tick with its interrupts, worst", max(whole) / 16, "us"),
    ]


def apply(bench: Bench, values: dict[str, int]) -> None:
    """Runs a whole parameter set: the defaults but for these."""
    wanted = list(schema.DEFAULTS)
    for key, value in values.items():
        wanted[schema.PARAMETER_BY_NAME[key].index] = value
    for i, value in enumerate(wanted):
        bench.ask(schema.ParamSetRequest, struct.pack("<Hi", i, value))
    bench.ask(schema.ParamApplyRequest, struct.pack("<H", schema.param_crc(wanted)))


def over_parameters(name: str) -> Figure:
    """The dearest tick over random sets for all joints, most of them where the sets bend, with the slowest low-pass."""
    bench, draw = Bench(name), Random(5)
    worst = 0.0
    for _ in range(SETS):
        bench.millivolts[:] = 2500.0
        bench.board.set_millivolts(bench.millivolts)
        bench.wait(30)
        values = {"filter_shift": 2, "soft_start_ms": 100, "tracking_limit": 0} | UNWATCHED
        for joint in range(4):
            values |= {f"joint{joint}.{key}": value for key, value in vars(draw.settings(1)).items()}
        apply(bench, values)
        bench.wait(30)
        bench.ask(schema.EnableRequest, struct.pack("<H", 0))
        bench.wait(110)
        for _ in range(TICKS_PER_SET):
            bench.wiggle(10.0 ** bench.random.uniform(0, 3.3))
            worst = max(worst, bench.tick_cycles()[1])
        bench.ask(schema.StopRequest)
    return Figure(f"{name}: tick, worst of {SETS * TICKS_PER_SET} over the parameters", worst, "cycles")


def jitter(name: str) -> Figure:
    """Of the tick's interrupt, which starts the first conversion itself, while telemetry and noise use the link."""
    bench = Bench(name)
    bench.ask(schema.TelemetryRequest, struct.pack("<H", 1))
    first = bench.next_entry()
    late = []
    for i in range(1, TICKS):
        bench.run_to(first + CYCLES_PER_TICK * (i - 1) + int(bench.random.integers(9_000, 15_800)))
        bench.board.uart_send(bench.random.bytes(30))
        bench.run_to(first + CYCLES_PER_TICK * i - 150)
        late.append(bench.next_entry() - first - CYCLES_PER_TICK * i)
    spread = (max(late) - min(late)) / 16
    return Figure(f"{name}: tick jitter", spread, "us", "<= 10 us", spread <= 10)


def latency(name: str) -> list[Figure]:
    """From a step at a leader pot to the first change of the duty, over all phases of the tick."""
    bench = Bench(name)
    apply(bench, UNWATCHED)
    bench.ask(schema.EnableRequest, struct.pack("<H", 0))
    bench.wait(1100)
    delays = []
    for _ in range(60):
        bench.wait(40 + bench.random.uniform(0, 1))  # the low-pass has settled
        bench.millivolts[0] += 300.0 if bench.millivolts[0] < 2500 else -300.0
        bench.board.set_millivolts(bench.millivolts)
        start, duty = bench.board.cycle, bench.board.duty(*bench.output)
        while bench.board.duty(*bench.output) == duty:
            bench.board.run_until(bench.board.cycle + 16)
        delays.append((bench.board.cycle - start) / CYCLES_PER_TICK)
    mean = float(np.mean(delays))
    return [
        Figure(f"{name}: leader pot to duty, mean over the phases of the tick", mean, "ms"),
        Figure(f"{name}: leader pot to duty, worst phase", max(delays), "ms", "<= 1.3 ms", max(delays) <= 1.3),
    ]


def memory(name: str) -> Figure:
    """Variables and the deepest stack of a life: boot, every request, a set applied and saved, following, noise."""
    bench = Bench(name)
    for message in (schema.HelloRequest, schema.StatusRequest, schema.StopRequest, schema.ClearFaultRequest):
        bench.ask(message)
    for i, value in enumerate(schema.DEFAULTS):
        bench.ask(schema.ParamSetRequest, struct.pack("<Hi", i, value))
    bench.ask(schema.ParamApplyRequest, struct.pack("<H", schema.param_crc(schema.DEFAULTS)))
    bench.ask(schema.ParamSaveRequest)
    bench.ask(schema.TelemetryRequest, struct.pack("<H", 1))
    bench.ask(schema.EnableRequest, struct.pack("<H", 0))
    bench.board.uart_send(bench.random.bytes(20_000))
    bench.wait(1500)
    total = bench.statics + bench.stack()
    return Figure(f"{name}: RAM with the deepest stack", total, "bytes", "<= 1,536 bytes", total <= 1536)


def run() -> list[Figure]:
    figures = []
    for name in BOARDS:
        figures += [*ticks(name), over_parameters(name), jitter(name), *latency(name), memory(name)]
    return figures
