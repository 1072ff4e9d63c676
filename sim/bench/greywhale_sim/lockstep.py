"""A bench in this process, in lock step with the host: it lives only while the host reads or waits.

No wall clock and no port come into it. The same requests and the same leader give the same log, byte for byte, however
busy the machine is. Everything else is as with a bench behind a serial port: a program opens it by its `port`.
"""

from __future__ import annotations

import itertools
import os
from pathlib import Path
from typing import Any

from greywhale.base.closing import Closing
from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.record import Recording, record
from greywhale.board.upload import run_set
from greywhale.protocol import schema
from greywhale.protocol.table import ParameterTable
from greywhale.protocol.transport import BAUD, LINES, Line, PortBusyError
from greywhale_sim import commands
from greywhale_sim.assemble import BenchOptions, build_bench
from greywhale_sim.bench import Bench
from greywhale_sim.pacing import Pacer
from greywhale_sim.server import Server

# One look at the line: so long does the bench live, in slices of 250 us.
LOOK_SLICES = 8
SAVE_S = 1.0  # what a board takes at most to store a set
_numbers = itertools.count()


class LockStepBench(Closing):
    """A context; `port` names it for `Device` and for every verb, `command` takes what a running bench takes."""

    def __init__(self, options: BenchOptions, bench: Bench | None = None) -> None:
        """With these options, or around a `bench` of them that has just been powered."""
        bench = bench or build_bench(options)
        self.port = f"bench in lock step {os.getpid()}.{next(_numbers)}"
        self._line = _Port(self.port)
        self.server = Server(
            bench,
            self._line,
            fast=True,
            eeprom=options.eeprom,
            pacer=Pacer(lambda: bench.time_s, lambda seconds: None),
            fast_slices=LOOK_SLICES,
        )
        LINES[self.port] = self._open

    def _open(self, restart: bool, baud: int) -> Line:
        return _LockStepLine(self.server, self._line, self._line.open(restart, baud))

    @property
    def bench(self) -> Bench:
        return self.server.bench

    def command(self, text: str) -> dict[str, Any]:
        """Carry out one bench command, for example "power off", and return its answer; a moment passes."""
        self.server.turn()
        return commands.run(self.server, text)

    def close(self) -> None:
        LINES.pop(self.port, None)
        self.server.close()


class _Port:
    """A serial port in memory, for a server. Its DTR is up from the first opening on, as Arduinos' hosts have it.

    The board is powered as the line is plugged in: the first opening finds it just started.
    """

    def __init__(self, path: str) -> None:
        self.path = path
        self.connected = False
        self._to_board = bytearray()
        self._to_host = bytearray()
        self._baud = BAUD
        self._new = True
        self._rises = False

    def open(self, restart: bool, baud: int) -> bool:
        """Open the port; True if the board starts with it."""
        if self.connected:
            raise PortBusyError(self.path)
        self.connected, self._baud = True, baud
        new, self._new = self._new, False
        self._rises = restart and not new
        return new or restart

    def hang_up(self) -> None:
        self.connected = False

    def give(self, data: bytes) -> None:
        self._to_board += data

    def take(self) -> bytes:
        return _empty(self._to_host)

    def poll(self) -> bool:
        rises, self._rises = self._rises, False
        return rises

    def baud(self) -> float:
        """The speed the host has set."""
        return self._baud

    def read(self) -> bytes:
        return _empty(self._to_board)

    def write(self, data: bytes) -> int:
        self._to_host += data
        return len(data)

    def backlog(self, limit: int) -> int:
        """A host in lock step is never behind."""
        return 0

    def discard_unread(self) -> None:
        self._to_host.clear()

    def close(self) -> None:
        """Nothing is open."""


class _LockStepLine:
    """The serial line of a bench as `greywhale.board.device.Device` needs it."""

    def __init__(self, server: Server, port: _Port, restarted: bool) -> None:
        self._server = server
        self._port = port
        self.restarted = restarted

    def read(self) -> bytes:
        """Let the bench live for a moment, and return what the board said."""
        self._server.turn()
        return self._port.take()

    def write(self, data: bytes) -> None:
        self._port.give(data)

    def close(self) -> None:
        self._port.hang_up()

    def clock(self) -> float:
        """The bench's own time, s."""
        return self._server.bench.time_s

    def wait(self, seconds: float) -> None:
        """Let the bench live for so long."""
        end = self.clock() + seconds
        while self.clock() < end:
            self._server.turn()


def _empty(data: bytearray) -> bytes:
    taken = bytes(data)
    data.clear()
    return taken


def tell_joints(bench: Bench, options: BenchOptions) -> None:
    """Store in the board which joints its arm has, as `greywhale calibrate --joints` does."""
    with LockStepBench(options, bench) as served, Device(served.port) as device:
        run_set(device, ParameterTable.defaults(device.hello.board).with_joints(bench.joints))
        device.ask(schema.ParamSaveRequest())
        bench.run(SAVE_S)
        if device.status().save_state is not schema.SaveState.SAVED:
            raise UserError("the board does not store which joints its arm has.")


def record_in_lock_step(
    path: Path, options: BenchOptions, table: ParameterTable, seconds: float, every: int = 1
) -> Recording:
    """Power a bench, run a parameter table on its board, enable the motors and record `seconds` of following.

    Raises UserError where the board stops the motors; what was recorded until then is kept.
    """
    with LockStepBench(options) as bench, Device(bench.port) as device:
        run_set(device, table)
        return record(device, path, seconds, every, enable=True)
