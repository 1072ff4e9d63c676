"""A line to a bench in this process, in lock step: the bench lives only while the host reads.

No wall clock and no port come into it. The same requests and the same leader give the same log, byte for byte, however
busy the machine is.
"""

from __future__ import annotations

import itertools
import os
from pathlib import Path
from typing import Any

from greywhale.board.device import Device
from greywhale.board.record import Recording, record
from greywhale.board.upload import run_set
from greywhale.errors import UserError
from greywhale.protocol import schema
from greywhale.table import ParameterTable
from greywhale_sim.assemble import BenchOptions, build_bench
from greywhale_sim.bench import Bench

# One look at the line: so long does the bench live, in slices of 250 us.
LOOK_SLICES = 8
# The bootloader of either board has ended by then.
QUIET_S = 4.0
PATIENCE_S = 8.0
SAVE_S = 1.0  # what a board takes at most to store a set
_numbers = itertools.count()


class LockStepLine:
    """The serial line of a bench as `greywhale.board.device.Device` needs it."""

    restarted = True

    def __init__(self, bench: Bench) -> None:
        self._bench = bench
        self._board: Any = bench.board

    def read(self) -> bytes:
        """Let the bench live for a moment, and return what the board said."""
        self._bench.run_slices(LOOK_SLICES)
        return bytes(self._board.uart_receive())

    def write(self, data: bytes) -> None:
        self._board.uart_send(data)

    def close(self) -> None:
        """Nothing is open."""

    def clock(self) -> float:
        """The bench's own time, s."""
        return self._bench.time_s


def tell_joints(bench: Bench) -> None:
    """Store in the board which joints its arm has, as `greywhale calibrate --joints` does."""
    with _device(bench) as device:
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
    with _device(build_bench(options)) as device:
        run_set(device, table)
        return record(device, path, seconds, every, enable=True)


def _device(bench: Bench) -> Device:
    name = f"bench in lock step {os.getpid()}.{next(_numbers)}"
    return Device(name, QUIET_S, PATIENCE_S, line=LockStepLine(bench))
