"""Listens while a port is held, so that `greywhale stop` in another terminal can end it without opening the port.

Whoever connects asks for a stop: the thread that listens sends it to the board at once, then ends the main thread as
Ctrl-C does. From then on this session starts no motor. The answer goes out when the board has confirmed that its motors
are off. Nobody who keeps silent, or reads slowly, holds the others up: the thread waits for none of them.
"""

from __future__ import annotations

import contextlib
import json
import logging
import os
import signal
import socket
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self

from greywhale.base import system
from greywhale.base.errors import UserError, os_reason
from greywhale.board import meeting
from greywhale.board.limits import PATIENCE
from greywhale.protocol.holder import describe
from greywhale.protocol.lines import device_of
from greywhale.protocol.transport import LENT

NOTE = "It was stopped with `greywhale stop` from another terminal."
# An interrupt that comes just before the main thread falls asleep in a system call is noticed only when the call ends.
# So a signal that does nothing (system.WAKE) ends the call, again and again until the session does.
_WAKE_S = 0.05
_open: dict[str, Session] = {}
logger = logging.getLogger(__name__)


class StopAsked(KeyboardInterrupt):
    """A stop was asked for elsewhere, where no Ctrl-C reaches this session."""


class Session:
    """This process's hold on a port, a context. A second one of the same port in this process joins the first."""

    def __init__(self, port: str) -> None:
        self.port = port
        self._key = _key(port)
        self._device = None if port in LENT else device_of(port)  # whoever lends a port listens for it
        self.asked = False
        self.goes_on = False  # this process goes on after a stop, as a server does
        self._users = 0
        self._send_stop: Callable[[], None] | None = None
        self._send_clutch: Callable[[str], None] | None = None
        self._ended = False  # by an exception or an interrupt, once
        self._unreachable = ""  # why `greywhale stop` does not reach this session
        self._interrupts = threading.current_thread() is threading.main_thread()
        self._interrupted = False
        self._outcome: dict[str, Any] = {}
        self._confirmed = threading.Event()
        self._confirm_until = 0.0
        self._thread: threading.Thread | None = None

    @classmethod
    def of(cls, port: str) -> Session:
        """The session of this process on a port, a new one where there is none."""
        return _open.setdefault(_key(port), cls(port))

    def __enter__(self) -> Self:
        self._users += 1
        if self._users == 1:
            try:
                self._listen()
            except BaseException:
                self._leave()
                raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.explain(error)
        self._leave()

    def explain(self, error: BaseException | None) -> None:
        """Say with an interrupt that it came from elsewhere."""
        if self.asked and isinstance(error, KeyboardInterrupt) and NOTE not in getattr(error, "__notes__", ()):
            error.add_note(NOTE)

    @property
    def waiting(self) -> bool:
        """True if somebody asked for a stop and has no answer yet."""
        return self.asked and not self._confirmed.is_set()

    def attach(self, send_stop: Callable[[], None], send_clutch: Callable[[str], None]) -> None:
        """The port is open; both send from any thread, without waiting for the answer: a stop, or engage, disengage."""
        self._send_stop, self._send_clutch = send_stop, send_clutch

    def detach(self) -> None:
        """The port is closed, and so no motor is on by this session."""
        self._send_stop = self._send_clutch = None
        if self.asked:
            self.confirm({"state": None})

    def check(self) -> None:
        """End a session that was asked to stop and that no Ctrl-C reached."""
        if self.asked and not self._ended:
            self._ended = True
            raise StopAsked

    def refuse_motion(self) -> None:
        """End a session before it starts a motor, if it was asked to stop, or if nothing could stop it later."""
        if self.asked:
            raise StopAsked
        if self._unreachable:
            self._rely_on_ctrl_c()

    def confirm(self, outcome: dict[str, Any]) -> None:
        """Answer those who asked for a stop with its outcome: confirmed by the board, or not. The first one counts."""
        if self.waiting:
            self._outcome = outcome
            self._confirmed.set()
            self._wake(b"c")

    def _rely_on_ctrl_c(self) -> None:
        """Say once that only Ctrl-C stops this session; where that does not reach it either, refuse."""
        problem = f"{self.port}: `greywhale stop` cannot reach this session, because {self._unreachable}"
        if not (self._interrupts and system.in_foreground()):
            raise UserError(
                f"{problem}; nor can the Ctrl-C of a terminal, so the motors stay off: run it in the foreground of a "
                "terminal, or end what is in the way."
            )
        logger.warning("%s; only Ctrl-C in this terminal stops the arm.", problem)
        self._unreachable = ""

    # --- the socket -------------------------------------------------------------------------------------------------

    def _listen(self) -> None:
        """Begin to listen. What is no device, such as a board in this process, holds nothing that others could want."""
        if self._device is None:
            return
        try:
            listener = meeting.listen(self.port, self._device)
        except OSError as error:
            self._unreachable = os_reason(error)
            return
        self._wake_out, self._wake_in = os.pipe()
        if self._interrupts:
            self._woken_before = signal.signal(system.WAKE, lambda number, frame: None)
        clients = meeting.Clients(listener)
        self._thread = threading.Thread(target=self._serve, args=(clients,), name="greywhale-stop", daemon=True)
        self._thread.start()

    def _leave(self) -> None:
        self._users -= 1
        if self._users:
            return
        _open.pop(self._key, None)
        if self._thread is None:
            return
        self._wake(b"x")
        self._thread.join()
        self._thread = None
        if self._interrupts:
            signal.signal(system.WAKE, self._woken_before)
        os.close(self._wake_out)
        os.close(self._wake_in)

    def _wake(self, why: bytes) -> None:
        """Let the thread look: at its end (x), or at the outcome of a stop (c)."""
        if self._thread is not None:
            os.write(self._wake_in, why)

    def _serve(self, clients: meeting.Clients) -> None:
        """Answer until the session ends; its end also closes the connections, so that a client can wait for it."""
        ended = False
        while not ended:
            pause_s = self._wake_main_thread() or (_WAKE_S if clients.asking else None)
            ready = system.readable([self._wake_out, *clients.descriptors()], pause_s)
            ended = self._wake_out in ready and b"x" in os.read(self._wake_out, 64)
            if clients.hear(ready):
                self.asked = True
                self._confirm_until = time.monotonic() + PATIENCE.confirm_s
                self._end_motion()
            while clients.clutching:
                self._use_clutch(*clients.clutching.pop())
            if clients.asking:
                self._answer(clients)
        clients.close()

    def _use_clutch(self, action: str, client: socket.socket) -> None:
        """Send it on, and say so; without an open port hang up."""
        send = self._send_clutch
        with client, contextlib.suppress(UserError, OSError):  # the main thread finds out by itself
            if send is not None:
                send(action)
                client.send(b"\n")

    def _answer(self, clients: meeting.Clients) -> None:
        """Tell those who asked what came of it, as soon as it is known."""
        if self.waiting and time.monotonic() > self._confirm_until:
            within = f"within {PATIENCE.confirm_s:g} s"
            problem = f"Switch the motors' supply off: {self.port} does not confirm the stop {within}."
            self.confirm({"problem": problem})
        if self._confirmed.is_set():
            answer = {"pid": os.getpid(), **self._outcome, **({"goes_on": True} if self.goes_on else {})}
            clients.answer(json.dumps(answer).encode() + b"\n")

    def _end_motion(self) -> None:
        """Send the stop, and end what runs as Ctrl-C would, where the main thread may be interrupted."""
        send = self._send_stop
        if send is None:
            self.confirm({"state": None})
        else:
            with contextlib.suppress(UserError):  # the main thread finds out by itself
                send()
        if self._interrupts and callable(signal.getsignal(signal.SIGINT)) and not self._ended:
            self._ended = self._interrupted = True
            system.signal_main_thread(signal.SIGINT)

    def _wake_main_thread(self) -> float | None:
        """See that an interrupt is noticed: in how many seconds again, None where none was sent."""
        if not self._interrupted:
            return None
        system.signal_main_thread(system.WAKE)
        return _WAKE_S


def ask_to_stop(port: str, wait_for_end: bool = False, heard_s: float = PATIENCE.heard_s) -> dict[str, Any] | None:
    """Stop the session that holds a port: its answer with "pid" and "state", and "goes_on" where its process does;
    None where no session holds the port.

    The answer comes when the motors are off. With `wait_for_end` this returns when the port is free too.
    """
    found = meeting.find(port, heard_s)
    if found is None:
        return None
    client, peer = found
    with client:
        try:
            client.settimeout(heard_s)
            client.sendall(b"stop\n")
            answer = client.recv(1)  # it has heard
            client.settimeout(PATIENCE.confirm_s + heard_s)
            answer = answer and _read_line(client)
            while wait_for_end and client.recv(64):
                pass
        except TimeoutError:
            raise UserError(
                f"Switch the motors' supply off: {port} is held by {describe(peer.pid)}, which does not answer. Then "
                f"bring it back (`fg`, after Ctrl-Z) or end it with `kill -9 {peer.pid}`."
            ) from None
        except OSError:  # it was killed
            answer = b""
    if not answer:
        raise UserError(f"{port}: the session ended before it confirmed the stop; run `greywhale stop` again.")
    outcome: dict[str, Any] = json.loads(answer)
    if "problem" in outcome:
        raise UserError(outcome["problem"])
    return outcome


def ask_for_clutch(port: str, action: str, heard_s: float = PATIENCE.heard_s) -> int | None:
    """Have the session that holds a port engage or disengage the clutch: its process, None where none holds it."""
    found = meeting.find(port, heard_s)
    if found is None:
        return None
    client, peer = found
    heard = b""
    with client, contextlib.suppress(OSError):
        client.settimeout(heard_s)
        client.sendall(f"{action}\n".encode())
        heard = client.recv(1)
    if not heard:
        raise UserError(f"{port}: {describe(peer.pid)} has the port, but not open just now; try again in a moment.")
    return peer.pid


def _key(port: str) -> str:
    """The key that all names of a port share."""
    return device_of(port) or os.path.realpath(port)


def _read_line(client: socket.socket) -> bytes:
    """One line, empty where the other end closed before its end."""
    line = b""
    while not line.endswith(b"\n"):
        data = client.recv(4096)
        if not data:
            return b""
        line += data
    return line
