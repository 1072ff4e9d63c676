"""A port that fails in the middle: gone, read by another program, or set by it; each has its own sentence."""

from __future__ import annotations

import fcntl
import os
import struct
import termios
import tty
from collections.abc import Callable, Iterator

import pytest
import serial

from greywhale.base import system
from greywhale.base.errors import UserError
from greywhale.protocol.lines import open_line
from greywhale.protocol.transport import (
    PortBusyError,
    PortDisturbedError,
    PortLostError,
    Transport,
    disturbance,
)
from tests.board.port_board import locked, opened

_TIOCGEXCL = 0x80045440  # whether a terminal keeps others out; Python does not name it


class Terminal:
    """A pseudo-terminal as a port: its other end, and the name under which it is opened."""

    def __init__(self) -> None:
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        self.port = os.ttyname(self.slave)

    def close(self) -> None:
        for descriptor in (self.master, self.slave):
            if descriptor >= 0:
                os.close(descriptor)
        self.master = self.slave = -1

    def set(self, place: int, value: int) -> None:
        """Change what termios has in one place, as any program may."""
        settings = termios.tcgetattr(self.slave)
        settings[place] = value
        termios.tcsetattr(self.slave, termios.TCSANOW, settings)

    def set_speed(self, speed: int) -> None:
        for place in (4, 5):
            self.set(place, speed)


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    made = Terminal()
    yield made
    made.close()


@pytest.fixture
def line(terminal: Terminal) -> Iterator[Transport]:
    opened_line = Transport(terminal.port, restart=False)
    yield opened_line
    opened_line.close()


def steal(*_: object) -> bytes:
    """Fail as pyserial does when somebody else was quicker, and when a cable is out."""
    raise serial.SerialException(
        "device reports readiness to read but returned no data (device disconnected or multiple access on port?)"
    )


def failure(use: Callable[[], object]) -> UserError:
    with pytest.raises(UserError) as caught:
        use()
    return caught.value


def test_a_second_reader_is_named_and_no_cable_blamed(
    terminal: Terminal, line: Transport, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(serial.Serial, "read", steal)
    with opened(terminal.port) as process:
        error = failure(line.read)
    assert isinstance(error, PortDisturbedError)
    assert error.message.startswith(f"{terminal.port}: another program, process {process} (")
    assert "reads from the port too" in error.message
    assert "close that program" in error.message
    error = failure(line.read)  # it has ended meanwhile, or is another user's
    assert error.message.startswith(f"{terminal.port}: another program reads from the port too")
    assert "cable" not in error.message


def test_a_port_that_went_away_is_no_second_reader(terminal: Terminal, line: Transport) -> None:
    terminal.close()
    for use in (line.read, lambda: line.write(b"x")):
        error = failure(use)
        assert isinstance(error, PortLostError)
        assert "the port went away in the middle; check the cable" in error.message
    assert disturbance(line) is None


def test_a_port_that_is_closed_under_a_reader_went_away(line: Transport) -> None:
    line.close()
    assert isinstance(failure(line.read), PortLostError)
    assert disturbance(line) is None


@pytest.mark.parametrize(
    ("speed", "says"),
    [
        (termios.B9600, "set the port to 9600 baud instead of 1000000"),
        (termios.B115200, "set the port to 115200 baud instead of 1000000"),
        (termios.B57600, "set the port to 57600 baud instead of 1000000"),
    ],
)
def test_another_speed_is_told(terminal: Terminal, line: Transport, speed: int, says: str) -> None:
    terminal.set_speed(speed)
    found = disturbance(line)
    assert found is not None
    assert found.message.startswith(f"{terminal.port}: another program {says}")
    with opened(terminal.port) as process:
        assert f"process {process} (" in (disturbance(line) or found).message


def test_other_settings_are_told(terminal: Terminal, line: Transport) -> None:
    terminal.set(3, termios.ICANON | termios.ECHO)
    found = disturbance(line)
    assert found is not None
    assert "changed the settings of the port" in found.message


def test_the_same_settings_again_and_the_own_flag_of_dtr_are_no_disturbance(
    terminal: Terminal, line: Transport
) -> None:
    terminal.set_speed(termios.B1000000)
    for hang_up in (termios.HUPCL, 0):
        flags = termios.tcgetattr(terminal.slave)[2] & ~termios.HUPCL
        terminal.set(2, flags | hang_up)
        assert disturbance(line) is None


def test_who_only_has_the_port_open_is_told_where_a_board_falls_silent(terminal: Terminal, line: Transport) -> None:
    assert disturbance(line) is None
    with opened(terminal.port) as process:
        found = disturbance(line)
    assert found is not None
    assert f"process {process} (" in found.message
    assert "has the port open too" in found.message


def test_a_busy_port_has_a_sentence_of_its_own(terminal: Terminal) -> None:
    with locked(terminal.port) as process:
        error = failure(lambda: open_line(terminal.port))
    assert isinstance(error, PortBusyError)
    assert f"the port is in use by process {process} (" in error.message


@pytest.mark.parametrize("restart", [True, False])
def test_others_are_kept_out_of_a_devices_port_until_it_is_closed(
    terminal: Terminal, monkeypatch: pytest.MonkeyPatch, restart: bool
) -> None:
    def kept() -> int:
        return int(struct.unpack("i", fcntl.ioctl(terminal.slave, _TIOCGEXCL, b"\0\0\0\0"))[0])

    line = Transport(terminal.port, restart)
    assert kept() == 0, "a bench has a pseudo-terminal open too, and it would stay closed after a host was killed"
    line.close()
    monkeypatch.setattr(system, "PSEUDO_TERMINALS", range(0))
    line = Transport(terminal.port, restart)
    assert kept() == 1
    line.close()
    assert kept() == 0
