"""A line that another process lends: whole, from its opening on, and lost when its lender ends."""

from __future__ import annotations

import contextlib
import socket
import threading
from collections.abc import Iterator

import pytest

from greywhale.board.device import Device
from greywhale.board.session import Session, ask_to_stop
from greywhale.protocol.lent_line import lend
from greywhale.protocol.lines import open_line
from greywhale.protocol.transport import LENT, PortLostError
from tests.board.fake_board import FakeBoard

PORT = "/dev/null"  # a device that any system has: a lender has its name already


@pytest.fixture
def lender() -> Iterator[socket.socket]:
    """The other end of a line that is lent in the place of a port."""
    own, theirs = socket.socketpair()
    lend(PORT, theirs)
    with own, theirs:
        yield own
    del LENT[PORT]


def test_what_was_said_before_it_is_opened_is_nobodys(lender: socket.socket) -> None:
    lender.sendall(b"before")
    line = open_line(PORT)
    assert not line.restarted
    assert line.read() == b""
    lender.sendall(b"after")
    assert line.read() == b"after"
    line.close()
    lender.sendall(b"in between")
    assert open_line(PORT).read() == b""


def test_all_that_is_written_arrives(lender: socket.socket) -> None:
    """Also more than a socket takes at once."""
    whole, got = bytes(range(256)) * 4096, bytearray()

    def take() -> None:
        while len(got) < len(whole):
            got.extend(lender.recv(4096))

    thread = threading.Thread(target=take)
    thread.start()
    open_line(PORT).write(whole)
    thread.join()
    assert got == whole


def test_its_end_is_a_lost_port(lender: socket.socket) -> None:
    line = open_line(PORT)
    lender.close()
    with pytest.raises(PortLostError, match=f"{PORT}: the port went away"):
        line.read()
    with pytest.raises(PortLostError):
        line.write(b"x")


def test_who_lends_a_port_listens_for_it(lender: socket.socket) -> None:
    """So a second greywhale in the way is no reason to refuse, and no stop comes here."""
    with Session.of(PORT):
        assert ask_to_stop(PORT) is None


def test_a_device_is_greeted_over_it(lender: socket.socket) -> None:
    with FakeBoard() as board:
        line = board.open(False, 0)
        ended = threading.Event()
        lender.setblocking(False)

        def serve() -> None:
            while not ended.is_set():
                with contextlib.suppress(BlockingIOError):
                    line.write(lender.recv(4096))
                lender.sendall(line.read())

        thread = threading.Thread(target=serve)
        thread.start()
        try:
            with Device(PORT) as device:
                assert not device.restarted
                assert device.status().state.key == "disabled"
        finally:
            ended.set()
            thread.join()
