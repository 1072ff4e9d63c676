"""The board in Python on a pseudo-terminal: for hosts in processes of their own, and for who holds a port.

Its time runs with the samples it sends, and waits while its host has not read them.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import select
import struct
import subprocess
import sys
import termios
import threading
import time
import tty
from collections.abc import Iterator
from typing import Self

from greywhale.protocol.schema import State
from tests.board.fake_board import FakeBoard, Faults

# More unread bytes than this stop the board's time, as they stop the bench's.
_UNREAD = 256
_TICK_S = 0.0002


class PortBoard(FakeBoard):
    """Use as a context manager; it lives in a thread."""

    def __init__(self, faults: Faults | None = None) -> None:
        super().__init__(faults)
        self.problem: BaseException | None = None
        self._alone = self._busy = False
        self._end = threading.Event()
        self._changed = threading.Condition()
        self._ticks_in_state = 0

    def __enter__(self) -> Self:
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        flags = termios.tcgetattr(self._slave)
        flags[2] |= termios.HUPCL  # as serial ports have it, unlike pseudo-terminals
        termios.tcsetattr(self._slave, termios.TCSANOW, flags)
        os.set_blocking(self._master, False)
        self.port = os.ttyname(self._slave)
        self._wake_out, self._wake_in = os.pipe()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        self._end.set()
        os.write(self._wake_in, b"x")
        self._thread.join(10)
        assert not self._thread.is_alive()
        for descriptor in (self._master, self._slave, self._wake_in, self._wake_out):
            if descriptor >= 0:
                os.close(descriptor)
        if self.problem is not None and error is None:
            raise self.problem

    def wait_for(self, state: State, ticks: int, host: subprocess.Popen[str]) -> None:
        """Return when the board has been in this state for so many ticks, or fail when its host ends before."""

        def reached() -> bool:
            return self.problem is not None or (self.state is state and self._ticks_in_state >= ticks)

        with self._changed:
            while not self._changed.wait_for(reached, timeout=0.5):
                assert host.poll() is None, f"the host ended with {host.returncode}: {host.communicate()}"
        assert self.problem is None

    def hurry(self) -> None:
        """Nobody listens any more: what the board says is lost, and its time goes on as quickly as it can. Returns when
        it has done what it was asked to.
        """
        self._alone = True
        while self.problem is None and (select.select([self._master], [], [], 0)[0] or self._busy):
            time.sleep(0.0002)

    def say(self, data: bytes) -> None:
        """Bytes to the host, whatever they mean."""
        while data and not self._alone and not self._end.is_set():
            try:
                data = data[os.write(self._master, data) :]
            except BlockingIOError:
                select.select([self._wake_out], [self._master], [])

    def _run(self) -> None:
        try:
            while not self._end.is_set() and self._master >= 0:
                room = self._alone or (self._unread() < _UNREAD and not self._waits_for_host())
                # A tick takes a moment, in which the kernel moves what was written to where it counts as unread.
                timeout = 0.0 if self._alone else _TICK_S if self._every or self.chatters else None
                ready, _, _ = select.select([self._master, self._wake_out], [], [], timeout)
                if self._master in ready:
                    self._busy = True
                    self.hear(os.read(self._master, 4096))
                    self._busy = False
                elif room:
                    self.live()
        except BaseException as error:
            with self._changed:
                self.problem = error
                self._changed.notify_all()

    def live(self) -> None:
        before = self.state
        super().live()
        with self._changed:
            self._ticks_in_state = self._ticks_in_state + 1 if self.state is before else 0
            self._changed.notify_all()

    def _waits_for_host(self) -> bool:
        """For the renewal of a lease: on a busy machine it comes later than the ticks that it is for."""
        moving = self.state in (State.SOFT_START, State.FOLLOWING)
        return bool(self._lease_ms) and moving and self.tick >= self._lease_end - self._lease_ms // 2

    def _unread(self) -> int:
        # What this side wrote and the host has not read waits in the other end's input queue.
        waiting = fcntl.ioctl(self._slave, termios.FIONREAD, b"\0\0\0\0")
        return int(struct.unpack("i", waiting)[0])

    def unplug(self) -> None:
        # The host holds the other end of the pair; hanging up means closing both of ours.
        self._every = 0
        os.close(self._master)
        os.close(self._slave)
        self._master = self._slave = -1


def locked(port: str) -> contextlib.AbstractContextManager[int]:
    """A process that has the port open for itself alone, and is no greywhale: its number."""
    return _elsewhere(port, "import fcntl; fcntl.flock(port, fcntl.LOCK_EX)")


def opened(port: str, and_then: str = "") -> contextlib.AbstractContextManager[int]:
    """A process that has the port open and asks nobody, and what it does with the file `port`: its number."""
    return _elsewhere(port, and_then)


@contextlib.contextmanager
def _elsewhere(port: str, does: str) -> Iterator[int]:
    program = f"import sys; port = open(sys.argv[1], 'rb', 0); {does}\nprint(flush=True); input()"
    command = [sys.executable, "-c", program, port]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        yield process.pid
        process.communicate(b"\n")
