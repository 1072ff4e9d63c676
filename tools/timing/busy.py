"""The dearest pieces of the main loop's work that a busy hour finds on the simulated boards: requests of every kind, a
set applied, refused and saved, the host's lead, a joint that hunts until the safe set stands in.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

import numpy as np

from greywhale.protocol import frames, schema
from greywhale.protocol.declared import Message
from tools.timing import facts, loops
from tools.timing.cycles import Chip
from tools.timing.graph import Graph, build
from tools.timing.image import PERIOD, SERVICE, Target
from tools.timing.listing import Program, read_program
from tools.timing.measure import RAIL_MV, STACK_POINTER, Session

LOOK, WATCH, AFTER = "app::App::look_at_joint", "app::App::watch_memory", "app::App::after_tick"
QUIET_CHECKS = {"tracking_limit": 0, "speed_limit": 0, "runaway_limit": 0, "stall_volts": 0}
STILL_FINE = 3  # swings of 40 ms: unrest takes 0.2 s at least
FAST = {"speed_limit": 1}
HUNTS = {"unrest_amplitude": 10, "unrest_rate": 10, "unrest_time": 2, "unrest_action": 1}

# While a set is being applied nothing is read. Of what has come meanwhile three pieces take all but the last zero of
# the longest frame, and the fourth takes that and what follows.
LONG = bytes(7) + bytes([53]) + bytes([1]) * 52 + b"\0"

FLOOD = bytes([7]) * 1200  # of them the fourth tick in a row that loses some turns the motors off


class Watch:
    """Which piece of work the main loop does, by the addresses that it passes."""

    def __init__(self, program: Program, chip: Chip) -> None:
        self.entry = program.entry(SERVICE)
        graph = build(program, self.entry, chip)
        self.looked = next(program.at(at).next for at, to in graph.calls.items() if program.name(to) == AFTER)
        looks = {name: build(program, program.entry(name), chip) for name in (LOOK, WATCH)}
        parts = facts.load().parts
        self._safe = _addresses(program, looks[LOOK], parts["safe set"], LOOK)
        self._off = set().union(*(_addresses(program, looks[name], parts["off"], name) for name in looks))
        self._marks = {
            address: name
            for name in ("request", "flood", "restart", "answer", "lead", "crc", "rules", "joint", "end")
            for address in _addresses(program, graph, parts[name], "")
        }

    def looks(self, passed: list[int]) -> str:
        if self._safe.intersection(passed):
            return "safe set"
        return "look, off" if self._off.intersection(passed) else "look"

    def works(self, passed: list[int]) -> str:
        """By the first part that the call has come to; what comes to none is over sooner than any other."""
        first = next((self._marks[address] for address in passed if address in self._marks), "answer")
        if first == "flood":
            return "flood, request"
        return f"apply: {first}" if first in ("crc", "rules", "joint", "end") else first


def _addresses(program: Program, graph: Graph, parts: list[facts.Part], function: str) -> set[int]:
    """Where a function comes to these parts of it."""
    found: set[int] = set()
    for within, what in parts:
        kind, _, rest = what.partition(" ")
        if within != function:
            continue
        if kind == "call":
            found |= {at for at, to in graph.calls.items() if program.name(to) == rest}
        else:
            found |= loops.find(graph)[int(rest)].heads
    return found


def _ask(message: type[Message], payload: bytes = b"") -> bytes:
    return b"\0" + frames.encode_frame(message.TYPE, 1, payload)


class Busy:
    """A session whose main loop is watched."""

    def __init__(self, target: Target, seed: int) -> None:
        self.session = Session(target, seed)
        self.watch = Watch(read_program(target.elf), target.chip)
        self._wide = target.chip.return_address

    def pieces(self, ms: float) -> Iterator[tuple[str, int, list[int]]]:
        """For so long: each piece, its own cycles, and the addresses that it has passed, those of interrupts too."""
        board = self.session.board
        end = board.cycle + int(ms * PERIOD)
        while board.cycle < end:
            if board.pc == self.watch.entry:
                yield from self._call()
            else:
                board.run_until(board.cycle + 1)

    def _call(self) -> Iterator[tuple[str, int, list[int]]]:
        board = self.session.board
        level = int.from_bytes(board.peek(STACK_POINTER, 2), "little")
        back = 2 * int.from_bytes(board.peek(level + 1, self._wide), "big")
        start, passed = self._own_time(), [board.pc]
        while board.pc != back:
            board.run_until(board.cycle + 1)
            passed.append(board.pc)
            if board.pc == self.watch.looked:
                now = self._own_time()
                yield self.watch.looks(passed), now - start, passed
                start, passed = now, [board.pc]
        yield self.watch.works(passed), self._own_time() - start, passed

    def _own_time(self) -> int:
        return round(self.session.board.cycle - self.session.interrupt_cycles())

    def day(self) -> Iterator[tuple[str, int, list[int]]]:
        """All kinds of work."""
        session, board = self.session, self.session.board
        crc = struct.pack("<H", schema.param_crc(list(schema.DEFAULTS)))
        refused = schema.PARAMETER_BY_NAME["joint2.ne_c"]  # on the wrong side of zero
        other = [5 if n == refused.index else value for n, value in enumerate(schema.DEFAULTS)]
        requests = [
            _ask(schema.StatusRequest),
            _ask(schema.HelloRequest),
            _ask(schema.ParamGetRequest, struct.pack("<H", 93)),
            _ask(schema.ParamSetRequest, struct.pack("<Hi", refused.index, 5)),
            _ask(schema.ParamApplyRequest, struct.pack("<H", schema.param_crc(other))),
            _ask(schema.ParamApplyRequest, crc),  # which is not that of the staged set
            _ask(schema.ParamDefaultsRequest),
            _ask(schema.ParamApplyRequest, crc) + LONG + _ask(schema.LeadRequest, struct.pack("<H", 1000))[1:],
            _ask(schema.LeadPointRequest, struct.pack("<B4b", 0, 9, -9, 9, -9)),
            _ask(schema.StopRequest),
            _ask(schema.TelemetryRequest, struct.pack("<H", 1)),
            b"\0" + frames.encode_frame(schema.StatusRequest.TYPE, 1, bytes(48))[:-1],
            _ask(schema.EnableRequest, struct.pack("<H", 0)),
            bytes([5, 1, 1, 1, 1, 0]) * 3 + _ask(schema.RenewRequest, struct.pack("<H", 9)),
            _ask(schema.StopRequest),
            _ask(schema.EnableRequest, struct.pack("<H", 0)),
            FLOOD,
            _ask(schema.ClearFaultRequest),
        ]
        for request in requests:
            board.uart_send(request)
            yield from self.pieces(12)
        session.run_set(QUIET_CHECKS | FAST)
        board.set_millivolts(np.full(8, RAIL_MV / 2) + 500 * (np.arange(8) == 6))
        yield from self.pieces(30)
        session.run_set(QUIET_CHECKS | HUNTS)
        for swing in range(12):
            readings = np.full(8, RAIL_MV / 2)
            readings[4] += 150 if swing % 2 else -150
            board.set_millivolts(readings)
            if swing < STILL_FINE:
                session.wait(40)
            else:
                yield from self.pieces(40)
        board.uart_send(_ask(schema.ParamSaveRequest))
        yield from self.pieces(40)


def worst(target: Target, seed: int = 3) -> dict[str, int]:
    """The dearest of each piece, in cycles."""
    found: dict[str, int] = {}
    for name, cycles, _ in Busy(target, seed).day():
        found[name] = max(found.get(name, 0), cycles)
    return found
