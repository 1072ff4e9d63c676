"""The firmware's image as it was compiled on a simulated board, alone: no bootloader and no arm, a host of frames.

For those who measure it or attack it, in a checkout.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from greywhale._native import Board
from greywhale.protocol import frames, schema
from greywhale.protocol.declared import Reply_co, Request
from greywhale_sim.assemble import BUILDS
from greywhale_sim.programs import load_elf
from greywhale_sim.symbols import read_symbols
from greywhale_sim.wiring import BOARDS

CYCLES_PER_TICK = 16_000
PAINT_BYTE = 0xA5  # fills free RAM, so that the depth of the stack shows
PATIENCE_MS = 60  # a control period takes up to 50 ms, a tick 1 ms
STILL_RUNS = 0  # what run_until says of a board that neither ended nor crashed
SAVE_MS = 1000.0  # a save of a whole set takes up to 910 ms
UNWATCHED = {"speed_limit": 0, "runaway_limit": 0, "stall_volts": 0}  # potentiometers here move as no arm does
RUNNING = "_ZN3hal12_GLOBAL__N_17runningE"  # hal's flag, set from the timer's interrupt to the end of the tick
VECTOR = {"atmega2560": "__vector_21", "atmega328p": "__vector_14"}  # of the tick
RAM = {"atmega2560": (0x200, 0x2200), "atmega328p": (0x100, 0x900)}


class BoardWithImage:
    """A board that has booted, with all potentiometers in their middle; `builds` holds an image for each board."""

    def __init__(self, board: str, seed: int = 1, builds: Path = BUILDS) -> None:
        self.wiring = BOARDS[board]
        self.ram = RAM[self.wiring.mcu]
        self.random = np.random.default_rng(7)
        self.millivolts = np.full(8, 2500.0)
        self.board: Any = Board(self.wiring.mcu)
        elf = builds / self.wiring.environment / "firmware.elf"
        self.symbols = read_symbols(elf)
        load_elf(self.board, elf)
        self.board.power_on(seed)
        self.board.set_millivolts(self.millivolts)
        self.paint()
        self.boot()

    def boot(self) -> None:
        self.wait(60)

    # --- time and pins

    def wait(self, ms: float) -> None:
        self.board.run_until(self.board.cycle + int(ms * CYCLES_PER_TICK))

    @property
    def motors_on(self) -> bool:
        return bool(self.board.pin(self.wiring.enable.port, self.wiring.enable.bit))

    def duty(self) -> float:
        """Of joint 0."""
        pwm = self.wiring.motors[0].pwm
        return float(self.board.duty(pwm.timer, pwm.channel))

    def wiggle(self, millivolts: float) -> None:
        self.board.set_millivolts(self.millivolts + self.random.uniform(-millivolts, millivolts, 8))

    # --- the host

    def ask(self, request: Request[Reply_co]) -> Reply_co:
        """The answer; RuntimeError where the board refuses."""
        self.board.uart_receive()
        self.board.uart_send(frames.encode_frame(request.TYPE, 1, request.pack()))
        decoder = frames.FrameDecoder()
        for _ in range(PATIENCE_MS):
            self.wait(1)
            for frame in decoder.feed(self.board.uart_receive()):
                if frame.type == request.TYPE | schema.REPLY_BIT:
                    return request.reply(frame.payload)
        raise RuntimeError(f"the firmware did not do as asked: {request}")

    def status(self) -> schema.StatusReply:
        return self.ask(schema.StatusRequest())

    def stage(self, changes: Mapping[str, int], fresh: bool = False) -> list[int]:
        """Send the defaults but for these raw values; all values. On a `fresh` board others are defaults."""
        changed = {schema.PARAMETER_BY_NAME[name].index: raw for name, raw in changes.items()}
        values = [changed.get(index, raw) for index, raw in enumerate(schema.DEFAULTS)]
        for index in changed if fresh else range(len(values)):
            self.ask(schema.ParamSetRequest(index, values[index]))
        return values

    def apply(self, changes: Mapping[str, int], fresh: bool = False) -> list[int]:
        """Stage these values, and run them."""
        values = self.stage(changes, fresh)
        self.ask(schema.ParamApplyRequest(schema.param_crc(values)))
        return values

    def save(self) -> None:
        """Store the running set; RuntimeError where that fails."""
        self.ask(schema.ParamSaveRequest())
        self.wait(SAVE_MS)
        if self.status().save_state is not schema.SaveState.SAVED:
            raise RuntimeError("the firmware did not store its set")

    # --- memory

    @property
    def statics(self) -> int:
        return max(self.symbols[name].address for name in ("__bss_end", "_end")) - self.ram[0]

    def paint(self) -> None:
        """Fill the memory behind the variables, so that the stack leaves its traces there."""
        start = self.ram[0] + self.statics
        self.board.poke(start, bytes([PAINT_BYTE]) * (self.ram[1] - start))

    def stack(self) -> int:
        """The most bytes that the stack has had since the memory was painted."""
        start = self.ram[0] + self.statics
        free = self.board.peek(start, self.ram[1] - start)
        return len(free) - next(i for i, byte in enumerate(free) if byte != PAINT_BYTE)

    # --- cycles

    def run_to(self, address: int) -> int:
        """Run to an instruction; the cycle at which it begins. RuntimeError where the firmware does not come there."""
        self._step_until(lambda: bool(self.board.pc == address), f"address {address:#x}")
        return int(self.board.cycle)

    def _step_until(self, there: Callable[[], bool], where: str) -> None:
        last = self.board.cycle + PATIENCE_MS * CYCLES_PER_TICK
        while not there():
            if self.board.run_until(self.board.cycle + 1) != STILL_RUNS or self.board.cycle > last:
                raise RuntimeError(
                    f"the firmware did not come to {where} within {PATIENCE_MS} ms of the board's time: it crashed, or "
                    "the image is of other sources; build it again with `make firmware`"
                )

    def next_entry(self) -> int:
        """Run to the tick's interrupt; its cycle."""
        return self.run_to(self.symbols[VECTOR[self.wiring.mcu]].address)

    def interrupt_cycles(self) -> float:
        return float(sum(times.count * times.mean for times in self.board.stats().vectors.values()))

    def tick_cycles(self) -> tuple[int, float]:
        """Cycles from the tick's interrupt to the end of its work: with all interrupts, and the work alone."""
        running = next(symbol for name, symbol in self.symbols.items() if name.startswith(RUNNING)).address
        entry = self.next_entry()
        before = self.interrupt_cycles()
        self._step_until(lambda: bool(self.board.peek(running, 1)[0]), "the work of its tick")
        self._step_until(lambda: not self.board.peek(running, 1)[0], "the end of its tick")
        whole = int(self.board.cycle - entry)
        return whole, whole - (self.interrupt_cycles() - before)


def ram_of_a_life(board: str) -> int:
    """Bytes of variables and of the deepest stack: boot, every request, a set applied and saved, following, noise."""
    bench = BoardWithImage(board)
    for request in (schema.HelloRequest(), schema.StatusRequest(), schema.StopRequest(), schema.ClearFaultRequest()):
        bench.ask(request)
    bench.apply({})
    bench.ask(schema.ParamSaveRequest())
    bench.ask(schema.TelemetryRequest(1))
    bench.ask(schema.EnableRequest(0))
    bench.board.uart_send(bench.random.bytes(20_000))
    bench.wait(1500)
    return bench.statics + bench.stack()
