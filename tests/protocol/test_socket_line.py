"""A line over TCP: every failure is a sentence that names the port, and each connection restarts the board."""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator

import pytest

from greywhale.base.errors import UserError
from greywhale.board import meeting
from greywhale.board.session import Session
from greywhale.protocol.lines import open_line
from greywhale.protocol.socket_line import SocketLine
from greywhale.protocol.transport import PortLostError


@pytest.fixture
def listener() -> Iterator[socket.socket]:
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield server


def name_of(listener: socket.socket) -> str:
    return f"socket://127.0.0.1:{listener.getsockname()[1]}"


def test_bytes_go_both_ways_and_opening_restarts(listener: socket.socket) -> None:
    line = open_line(name_of(listener), restart=False)
    assert isinstance(line, SocketLine)
    assert line.restarted
    board, _ = listener.accept()
    with board:
        line.write(b"to the board")
        assert board.recv(100) == b"to the board"
        board.sendall(b"to the host")
        assert line.read() == b"to the host"
        assert line.read() == b""
    line.close()


def test_an_end_after_a_word_is_a_lost_port_and_one_before_is_a_refusal(listener: socket.socket) -> None:
    for word, kind, says in ((b"hello", PortLostError, "went away"), (b"", UserError, "hung up at once")):
        line = open_line(name_of(listener))
        board, _ = listener.accept()
        board.sendall(word)
        if word:
            assert line.read() == word
        board.close()
        with pytest.raises(kind, match=says):
            line.read()
        line.close()


def test_nobody_there_is_one_sentence(listener: socket.socket) -> None:
    port = name_of(listener)
    listener.close()
    with pytest.raises(UserError, match=rf"^{port}: no connection: connection refused; start a bench there"):
        open_line(port)


@pytest.mark.parametrize(
    "port", ["socket://", "socket://host", "socket://:5000", "socket://h:0", "socket://h:99999", "socket://h:5/x"]
)
def test_what_is_no_address_is_refused_by_name(port: str) -> None:
    with pytest.raises(UserError, match=r"this is no TCP port; write it as socket://127\.0\.0\.1:5000"):
        open_line(port)


def test_greywhale_stop_finds_the_session_that_holds_it() -> None:
    port = "socket://127.0.0.1:5000"
    with Session.of(port):
        found = meeting.find(port, 1.0)
        assert found is not None
        client, peer = found
        client.close()
        assert peer.pid == os.getpid()
    assert meeting.find(port, 0.0) is None
