"""Runs a bench behind a serial port until it is told to end; used by `greywhale sim` and `python -m
greywhale_sim`.
"""

from __future__ import annotations

import json
import math
import os
import select
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType

from greywhale.base import system
from greywhale.base.errors import BAD_USAGE, UserError
from greywhale.base.runtime import make_runtime_directory
from greywhale.files.outputs import require_files
from greywhale.protocol.joints import ALL
from greywhale.protocol.ports import forget_dead_benches
from greywhale_sim import commands
from greywhale_sim.assemble import BenchOptions, build_bench
from greywhale_sim.bench import Plant
from greywhale_sim.lockstep import tell_joints
from greywhale_sim.server import Port, Server
from greywhale_sim.socket_port import SocketPort

TURNS_PER_COMMAND = 16  # turns between two looks at the standard input


@dataclass(frozen=True)
class ServeOptions(BenchOptions):
    """A bench and how it is served."""

    speed: str = "1"  # "1" real time, "max" as fast as possible
    link: Path | None = None  # a lasting name for the port
    listen: str | None = None  # PORT or HOST:PORT: be a TCP port instead
    control: bool = field(default=False)  # take commands from standard input; its end ends the bench
    by_hand: bool = False  # the same for a person, who is answered in words


@contextmanager
def running(
    options: ServeOptions, plant: Plant | None = None, note: Callable[[str], None] = lambda text: None
) -> Iterator[Server]:
    """A server with an open port; it is cleaned up whatever happens. `plant` takes the place of the built-in arm.

    `note` is told in a sentence what the bench does without.
    """
    if options.speed not in ("1", "max"):
        raise UserError(f'speed "{options.speed}" is not known; say 1 (real time) or max.', 2)
    require_files(options.eeprom)  # else the first save fails, when the board already runs
    bench = build_bench(options, plant)
    if bench.joints != ALL and _is_new(options):
        tell_joints(bench, options)
    port = _open_port(options, note)
    server = Server(bench, port, fast=options.speed == "max", eeprom=options.eeprom)
    try:
        yield server
    finally:
        server.close()


def _open_port(options: ServeOptions, note: Callable[[str], None]) -> Port:
    if options.listen is None and system.HAS_BENCH_PORTS:
        from greywhale_sim.serial_port import SerialPort  # other systems have not what it needs

        return SerialPort(_links(options, note))
    if options.speed == "max":
        raise UserError("a TCP port does not tell how far its host has read; leave out --speed max.", BAD_USAGE)
    return SocketPort(options.listen or "0")


def _is_new(options: ServeOptions) -> bool:
    """True if the board comes with the project's firmware and parameters that nobody has set."""
    kept = options.eeprom is not None and options.eeprom.exists()
    return not options.blank and options.firmware is None and not kept


def serve(
    options: ServeOptions,
    on_ready: Callable[[str], None],
    plant: Plant | None = None,
    note: Callable[[str], None] = lambda text: None,
) -> None:
    """Serve until Ctrl-C, a request to terminate or, with control, the end of standard input; all these ends are
    normal.
    """
    with running(options, plant, note) as server, _ending_on_signals(server):
        on_ready(server.port.path if options.link is None else str(options.link))
        if options.control or options.by_hand:
            server.while_waiting = (ByHand if options.by_hand else Control)(server).look
        while not server.ending:
            for _ in range(TURNS_PER_COMMAND):
                server.turn()
            server.while_waiting()


@contextmanager
def _ending_on_signals(server: Server) -> Iterator[None]:
    """On a signal, let the running turn end, so that nothing is left half done; only the main thread gets signals."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def end(number: int, frame: FrameType | None) -> None:
        server.ending = True

    ends = [signal.SIGINT, signal.SIGTERM, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else [])]
    before = {number: signal.getsignal(number) for number in ends}
    for number, handler in before.items():
        if handler is not signal.SIG_IGN:  # nohup and background jobs ignore signals on purpose
            signal.signal(number, end)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _links(options: ServeOptions, note: Callable[[str], None]) -> list[Path]:
    """Names of the port: the one that `greywhale ports` looks for, and the one asked for."""
    named = [] if options.link is None else [options.link]
    try:
        forget_dead_benches()
        return [make_runtime_directory() / f"{options.board}-{os.getpid()}", *named]
    except UserError as error:
        note(f"{error.message} This bench runs, but no other program finds it by itself: name its port with --port.")
        return named


class Control:
    """Commands from standard input, answers as JSON lines on standard output."""

    def __init__(self, server: Server) -> None:
        self._server = server
        self._partial = b""

    def look(self) -> None:
        """Carry out what has arrived; never waits."""
        descriptor = sys.stdin.fileno()
        while select.select([descriptor], [], [], 0)[0]:
            data = os.read(descriptor, 4096)
            if not data:
                self._server.ending = True
                return
            *lines, self._partial = (self._partial + data).split(b"\n")
            for text in lines:
                self._answer(text.decode("utf-8", "replace"))

    def _answer(self, text: str) -> None:
        self._server.notice_host()  # who closed the port before the command was sent
        if text.strip() == commands.QUIT:
            self._server.ending = True
            return
        try:
            answer = commands.run(self._server, text)
        except UserError as error:
            answer = {"error": error.message}
        self._say(answer)

    def _say(self, answer: commands.CommandAnswer) -> None:
        print(json.dumps(answer), flush=True)


class ByHand(Control):
    """Commands typed by a person: answers in words, and a word when the hands are where they were sent."""

    _arrives_s = math.inf

    def look(self) -> None:
        if self._server.bench.time_s >= self._arrives_s:
            self._arrives_s = math.inf
            print("There.", flush=True)
        super().look()

    def _say(self, answer: commands.CommandAnswer) -> None:
        self._arrives_s = answer.get("arrives_s", self._arrives_s)
        sentence = answer.get("error") or answer.get("says")
        print(sentence or "\n".join(f"{name}: {value}" for name, value in answer.items()), flush=True)
