"""The real image on a simulated board, with a host that only knows frames."""

from __future__ import annotations

import struct

import numpy as np

from greywhale.protocol import frames, schema
from greywhale.protocol.declared import Message
from greywhale_sim._board import Board
from greywhale_sim.symbols import Symbol, read_symbols
from tools import BUILT_FIRMWARE

CYCLES_PER_TICK = 16_000
PAINT = 0xA5
UNWATCHED = {"speed_limit": 0, "runaway_limit": 0, "stall_volts": 0}  # potentiometers here move as no arm does
RUNNING = "_ZN3hal12_GLOBAL__N_17runningE"  # hal's flag, set from the timer's interrupt to the end of the tick
BOARDS = {  # name: chip, environment, vector of the tick, RAM, duty output of joint 0
    "Mega": ("atmega2560", "megaatmega2560", "__vector_21", (0x200, 0x2200), (3, "A")),
    "Nano": ("atmega328p", "nanoatmega328", "__vector_14", (0x100, 0x900), (1, "A")),
}


class BoardWithImage:
    """See the head of this file."""

    def __init__(self, name: str) -> None:
        chip, environment, vector, self.ram, self.output = BOARDS[name]
        elf = BUILT_FIRMWARE / environment / "firmware.elf"
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


def apply(bench: BoardWithImage, values: dict[str, int]) -> None:
    """Runs a whole parameter set: the defaults but for these."""
    wanted = list(schema.DEFAULTS)
    for key, value in values.items():
        wanted[schema.PARAMETER_BY_NAME[key].index] = value
    for i, value in enumerate(wanted):
        bench.ask(schema.ParamSetRequest, struct.pack("<Hi", i, value))
    bench.ask(schema.ParamApplyRequest, struct.pack("<H", schema.param_crc(wanted)))


def ram_of_a_life(name: str) -> int:
    """Bytes of variables and of the deepest stack: boot, every request, a set applied and saved, following, noise."""
    bench = BoardWithImage(name)
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
    return bench.statics + bench.stack()
