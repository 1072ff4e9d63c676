"""Holds the board's port as every verb does, while the server runs: takes a board that comes, survives its loss."""

from __future__ import annotations

import contextlib
import logging
import threading
from collections.abc import Callable, Iterator

from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.greeting import FirmwareError
from greywhale.board.refusal import upper_first
from greywhale.board.session import Session, StopAsked
from greywhale.dashboard.limits import BOARD
from greywhale.dashboard.relay import Relay
from greywhale.protocol.ports import choose_port, lasting_name
from greywhale.protocol.transport import Line, PortBusyError, PortLostError

STOPPED = "The motors are off: `greywhale stop` was called in another terminal. The board is taken again in a moment."

logger = logging.getLogger(__name__)


class PortHolder:
    """A thread between its `start` and its `close`."""

    def __init__(self, relay: Relay, named: str | None, choose: Callable[[str | None], str] = choose_port) -> None:
        """`named` is the port, None for the only board that is found."""
        self._relay = relay
        self._named = named
        self._choose = choose
        self._ending = threading.Event()
        self._changed = threading.Condition()
        self._away = ""  # why the port is not to be held
        self._free = False
        self._thread = threading.Thread(target=self._run, name="greywhale-board", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def end(self) -> None:
        """Let `hold` return soon; from any thread."""
        self._ending.set()
        with self._changed:
            self._changed.notify_all()

    def close(self) -> None:
        """Motors off, port free."""
        self.end()
        self._thread.join()

    @contextlib.contextmanager
    def away(self, sentence: str) -> Iterator[str]:
        """Meanwhile the port is free for somebody who needs it itself: its name. The sentence tells pages why."""
        with self._changed:
            self._away = sentence
            self._changed.notify_all()
            free = self._changed.wait_for(lambda: self._free, BOARD.let_go_s)
        try:
            if not free:
                raise UserError("the board's port is not free yet; try again.")
            yield self._choose(self._named)
        finally:
            with self._changed:
                self._away = ""
                self._changed.notify_all()

    def _run(self) -> None:
        while not self._ending.is_set():
            pause_s = self.hold()
            with self._changed:
                self._changed.wait_for(lambda: bool(self._away) or self._ending.is_set(), pause_s)
                if self._away:
                    self._relay.close(self._relay.link["port"], self._away, unflashed=True)
                    self._free = True
                    self._changed.notify_all()
                    self._changed.wait_for(lambda: not self._away or self._ending.is_set())
                    self._free = False

    def hold(self) -> float:
        """Hold the board until it is lost or the server ends; after how many seconds to try again."""
        port, again_s = "", BOARD.look_again_s
        try:
            port, again_s = self._choose(self._named), BOARD.ask_again_s
            with Device(port, restart=False) as device:
                port = lasting_name(port)
                self._named = self._named and port  # the socket that it is plugged into, where that has a name
                self._share(device, port)
        except StopAsked:
            self._relay.close(port, STOPPED)
            return BOARD.after_stop_s
        except (PortLostError, PortBusyError) as error:
            self._tell(port, error)
            return BOARD.look_again_s
        except UserError as error:
            self._tell(port, error)
            return again_s
        return BOARD.look_again_s

    def _share(self, device: Device, port: str) -> None:
        """Share the board. At the end its clients are told why, then its motors are stopped and its port is closed."""
        line, session = device.lend()
        session.goes_on = True
        self._relay.open(line, port, session.refuse_motion)
        try:
            while not (self._ending.is_set() or self._away):
                turn(self._relay, line, session)
                line.wait(BOARD.round_s)
        except StopAsked:
            self._relay.stopped("with `greywhale stop` in another terminal")
            self._relay.close(port, STOPPED)
            raise
        except UserError as error:
            self._tell(port, error)
            raise
        self._relay.close(port, self._away, unflashed=bool(self._away))

    def _tell(self, port: str, error: UserError) -> None:
        logger.info("%s", error.message)
        self._relay.close(port, upper_first(error.message), isinstance(error, FirmwareError))


def turn(relay: Relay, line: Line, session: Session) -> None:
    """One round: what the board said goes on. Raises where the port went away or a stop was asked for."""
    session.check()
    relay.heard(line.read())
    relay.look()
