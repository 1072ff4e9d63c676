"""The boards that a killed verb leaves behind: in Python, and the real image on the simulated board."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import ExitStack
from typing import Protocol

from greywhale.board.device import Device
from greywhale.board.upload import change_parameters
from greywhale.demo import BenchProcess
from greywhale.protocol import schema
from greywhale.table import ParameterTable
from tests.board.fake_board import FakeBoard, Faults

# After this much of its own time a board whose host was killed has its motors off: its lease, and what was on its way.
LEASE_TICKS = 600
_PATIENCE_S = 60.0
_MOVING = (schema.State.SOFT_START, schema.State.FOLLOWING)


class Board(Protocol):
    """What a host opens. `stored` is the set that it keeps, None where that cannot be told. `settle` says after its
    host's death what is not as it must be; after `restart` another host can open it.
    """

    @property
    def port(self) -> str: ...

    @property
    def quick(self) -> bool:
        """Whether no bootloader needs time."""
        ...

    @property
    def stored(self) -> object: ...

    def settle(self) -> list[str]: ...

    def restart(self) -> None: ...


class NoBoard:
    """For verbs without one."""

    port, quick, stored = "", False, None

    def settle(self) -> list[str]:
        return []

    def restart(self) -> None:
        pass


class Fake:
    """The board in Python, whose time runs as quickly as one likes. `sets` are those that it may run and keep."""

    quick = True

    def __init__(self, stack: ExitStack, sets: Sequence[object]) -> None:
        self._stack, self._sets = stack, sets
        self._board = stack.enter_context(FakeBoard(Faults(patience_s=_PATIENCE_S)))

    @property
    def port(self) -> str:
        return self._board.port

    @property
    def stored(self) -> list[int]:
        return list(self._board.stored)

    def settle(self) -> list[str]:
        board, problems = self._board, []
        board.hurry()
        died, deadline = board.tick, time.monotonic() + _PATIENCE_S
        while board.state in _MOVING and board.tick < died + LEASE_TICKS and time.monotonic() < deadline:
            time.sleep(0.0005)
        if board.state in _MOVING:
            problems.append(f"the motors are on after {board.tick - died} ticks (lease {board.lease_ms} ms)")
        for name, values in (("runs", board.running), ("keeps", board.stored)):
            if self._sets and list(values) not in self._sets:
                problems.append(f"the board {name} a set that nobody asked for")
        if board.problem is not None:
            problems.append(f"the board met {board.problem!r}")
        return problems

    def restart(self) -> None:
        """As the opening of its port does: it runs what it keeps."""
        stored = self.stored
        self._board = self._stack.enter_context(FakeBoard(Faults(patience_s=_PATIENCE_S)))
        for values in (self._board.stored, self._board.running, self._board.staged):
            values[:] = stored


class Bench:
    """The real image on the simulated board, in a process of its own; it begins with the defaults."""

    quick = False

    def __init__(self, process: BenchProcess, sets: Sequence[object]) -> None:
        self._process, self._sets = process, sets
        with Device(self.port) as device:
            change_parameters(device, ParameterTable.defaults().by_name())

    @property
    def port(self) -> str:
        return self._process.port

    @property
    def stored(self) -> int:
        """The set that it runs after a restart, by its CRC."""
        with Device(self.port) as device:
            return device.hello.param_crc

    def settle(self) -> list[str]:
        died = self._process.command("status")["time_s"]
        while (now := self._process.command("status"))["time_s"] < died + LEASE_TICKS / 1000 and now["motors_enabled"]:
            pass
        problems = ["the motors are on after the lease"] if now["motors_enabled"] else []
        if self._sets and self.stored not in self._sets:
            problems.append("the board keeps a set that nobody asked for")
        return problems

    def restart(self) -> None:
        pass
