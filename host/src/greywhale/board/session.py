"""What holds a port listens here, so that `greywhale stop` in another terminal can end it without opening the port.

The socket lies in the runtime folder of this user alone, under a name made from the port's real path. Whoever connects
asks for a stop: the thread that listens sends it to the board at once, then ends the main thread as Ctrl-C does. From
then on this session starts no motor. The answer goes out when the board has confirmed that its motors are off.
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import json
import os
import select
import signal
import socket
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self

from greywhale.errors import UserError
from greywhale.runtime import make_runtime_directory, private_runtime_directory

NOTE = "It was stopped with `greywhale stop` from another terminal."
# A session that was asked to stop answers within this time, or says that the board does not confirm.
_CONFIRM_S = 5.0
# An interrupt that comes just before the main thread falls asleep in a system call is noticed only when the call ends.
# So this signal, which nobody else uses and which does nothing, ends the call, again and again until the session does.
_WAKE = signal.SIGURG
_WAKE_S = 0.05
_open: dict[str, Session] = {}


class StopAsked(KeyboardInterrupt):
    """A stop was asked for elsewhere, where no Ctrl-C reaches this session."""


class Session:
    """This process's hold on a port, a context. A second one of the same port in this process joins the first."""

    def __init__(self, port: str) -> None:
        self.port = port
        self.asked = False
        self._users = 0
        self._send_stop: Callable[[], None] | None = None
        self._told = False
        self._interrupts = threading.current_thread() is threading.main_thread()
        self._interrupted = False
        self._outcome: dict[str, Any] = {}
        self._confirmed = threading.Event()
        self._thread: threading.Thread | None = None

    @classmethod
    def of(cls, port: str) -> Session:
        """The session of this process on a port, a new one where there is none."""
        return _open.setdefault(os.path.realpath(port), cls(port))

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
        """Whether somebody asked for a stop and has no answer yet."""
        return self.asked and not self._confirmed.is_set()

    def attach(self, send_stop: Callable[[], None]) -> None:
        """The port is open; `send_stop` sends a stop from any thread, without waiting for the answer."""
        self._send_stop = send_stop

    def detach(self) -> None:
        """The port is closed, and so no motor is on by this session."""
        self._send_stop = None
        if self.asked:
            self.confirm({"state": None})

    def check(self) -> None:
        """End a session that was asked to stop and that no Ctrl-C reached."""
        if self.asked and not self._told:
            self._told = True
            raise StopAsked

    def refuse_motion(self) -> None:
        """End a session that was asked to stop before it starts a motor."""
        if self.asked:
            raise StopAsked

    def confirm(self, outcome: dict[str, Any]) -> None:
        """The board confirmed a stop, or did not: what those who asked are told. The first word counts."""
        if self.waiting:
            self._outcome = outcome
            self._confirmed.set()

    # --- the socket -------------------------------------------------------------------------------------------------

    def _listen(self) -> None:
        """Open the socket. Without a folder of this user's own a session runs without one."""
        try:
            self._path = make_runtime_directory() / socket_name(self.port)
        except UserError:
            return
        self._lock = self._hold()
        self._listener = socket.socket(socket.AF_UNIX)
        try:
            self._path.unlink(missing_ok=True)  # what a killed session left
            self._listener.bind(str(self._path))
            self._listener.listen()
        except OSError:  # such as a path too long for a socket
            self._listener.close()
            os.close(self._lock)
            return
        self._wake_out, self._wake_in = os.pipe()
        if self._interrupts:
            self._woken_before = signal.signal(_WAKE, lambda number, frame: None)
        self._thread = threading.Thread(target=self._serve, name="greywhale-stop", daemon=True)
        self._thread.start()

    def _hold(self) -> int:
        """A lock that the system takes away when this process ends, however it ends."""
        lock = os.open(f"{self._path}.lock", os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(lock)
            raise UserError(
                f"{self.port}: the port is in use by another greywhale; wait for its end, or stop it with "
                f"`greywhale stop --port {self.port}`."
            ) from None
        return lock

    def _leave(self) -> None:
        self._users -= 1
        if self._users:
            return
        _open.pop(os.path.realpath(self.port), None)
        if self._thread is None:
            return
        os.write(self._wake_in, b"x")
        self._thread.join()
        self._thread = None
        if self._interrupts:
            signal.signal(_WAKE, self._woken_before)
        self._path.unlink(missing_ok=True)
        os.close(self._lock)

    def _serve(self) -> None:
        """Answer until the session ends; its end also closes the connections, so that a client can wait for it."""
        clients: list[socket.socket] = []
        ended = False
        while not ended:
            ready, _, _ = select.select([self._listener.fileno(), self._wake_out], [], [], self._wake_main_thread())
            ended = self._wake_out in ready
            if self._listener.fileno() in ready:
                client, _ = self._listener.accept()
                clients.append(client)
                self._stop(client)
        for client in clients:
            client.close()
        self._listener.close()
        os.close(self._wake_out)
        os.close(self._wake_in)

    def _stop(self, client: socket.socket) -> None:
        with contextlib.suppress(OSError):
            client.settimeout(1.0)
            if not client.recv(16).startswith(b"stop"):
                return
            self.asked = True
            self._end_motion()
            if not self._confirmed.wait(_CONFIRM_S):
                self.confirm(
                    {
                        "problem": f"{self.port}: the stop is sent, but not confirmed within {_CONFIRM_S:g} s; "
                        "switch the motors' supply off."
                    }
                )
            client.sendall(json.dumps({"pid": os.getpid(), **self._outcome}).encode() + b"\n")

    def _end_motion(self) -> None:
        """Send the stop, and end what runs as Ctrl-C would, where the main thread may be interrupted."""
        send = self._send_stop
        if send is None:
            self.confirm({"state": None})
        else:
            with contextlib.suppress(UserError):  # the main thread finds out by itself
                send()
        if self._interrupts and callable(signal.getsignal(signal.SIGINT)) and not self._told:
            self._told = self._interrupted = True
            signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)

    def _wake_main_thread(self) -> float | None:
        """See that an interrupt is noticed: in how many seconds again, None where none was sent."""
        if not self._interrupted:
            return None
        signal.pthread_kill(threading.main_thread().ident or 0, _WAKE)
        return _WAKE_S


def socket_name(port: str) -> str:
    """The name of a port's socket. Its length is fixed: a socket's path must be short."""
    return "stop-" + hashlib.sha256(os.path.realpath(port).encode()).hexdigest()[:16]


def ask_to_stop(port: str, wait_for_end: bool = False) -> dict[str, Any] | None:
    """Stop the session that holds a port: its answer with "pid" and "state", None where no session holds the port.

    The answer comes when the motors are off. With `wait_for_end` this returns when the port is free too.
    """
    client = _connect(port)
    if client is None:
        return None
    with client:
        client.settimeout(2 * _CONFIRM_S)
        try:
            client.sendall(b"stop\n")
            answer = _read_line(client)
            while wait_for_end and client.recv(64):
                pass
        except TimeoutError:
            raise UserError(
                f"{port}: the session that holds the port does not answer; switch the motors' supply off."
            ) from None
        except OSError:  # it was killed
            answer = b""
    if not answer:
        raise UserError(f"{port}: the session ended before it confirmed the stop; run `greywhale stop` again.")
    told: dict[str, Any] = json.loads(answer)
    if "problem" in told:
        raise UserError(told["problem"])
    return told


def _connect(port: str) -> socket.socket | None:
    folder = private_runtime_directory()
    if folder is None:
        return None
    client = socket.socket(socket.AF_UNIX)
    try:
        client.connect(str(folder / socket_name(port)))
    except OSError:  # nobody listens
        client.close()
        return None
    return client


def _read_line(client: socket.socket) -> bytes:
    """One line, empty where the other end closed before its end."""
    line = b""
    while not line.endswith(b"\n"):
        data = client.recv(4096)
        if not data:
            return b""
        line += data
    return line
