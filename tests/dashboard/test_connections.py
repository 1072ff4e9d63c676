"""Strangers at the server's door: silent, slow, too many, another user's, or where no descriptor is left."""

from __future__ import annotations

import errno
import http.client
import os
import select
import socket
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import replace

import pytest
from starlette.responses import PlainTextResponse
from starlette.types import Receive, Scope, Send

from greywhale.base import sockets, system
from greywhale.dashboard import connections, guard, server
from greywhale.dashboard.door import Door
from greywhale.dashboard.guard import SUBPROTOCOL, Guard
from greywhale.dashboard.limits import CONNECTIONS, REQUESTS
from tests.dashboard.browser import PATIENCE_S as HANGS_S
from tests.dashboard.browser import Page

TOKEN = "secret"


async def application(scope: Scope, receive: Receive, send: Send) -> None:
    """Answers all requests, and says one thing on a WebSocket."""
    if scope["type"] == "http":
        await PlainTextResponse("there")(scope, receive, send)
        return
    await receive()
    await send({"type": "websocket.accept", "subprotocol": SUBPROTOCOL})
    while (await receive())["type"] != "websocket.disconnect":
        await send({"type": "websocket.send", "text": "there"})


@contextmanager
def serving(door: Door, listener: socket.socket | None = None) -> Iterator[Page]:
    listener = listener or server.listen()
    port: int = listener.getsockname()[1]
    running = server.make_server(Guard(application, TOKEN, port, lambda path: path == "/", door))
    thread = threading.Thread(target=running.run, args=([listener],))
    thread.start()
    try:
        yield Page(port, TOKEN)
    finally:
        running.should_exit = True
        thread.join()


def connect(page: Page, said: bytes = b"") -> socket.socket:
    connection = socket.create_connection(("127.0.0.1", page.port), HANGS_S)
    connection.sendall(said)
    return connection


def rest(connection: socket.socket) -> bytes:
    """All that it still says, until it closes."""
    said = b""
    with closing(connection), suppress(ConnectionResetError):
        while part := connection.recv(65536):
            said += part
    return said


def test_the_owner_works_on_while_strangers_take_all_that_they_get(caplog: pytest.LogCaptureFixture) -> None:
    with serving(Door(most_strangers=4)) as page, page.open("/board") as own, ExitStack() as held:
        for _ in range(3):
            idle = [held.enter_context(connect(page)) for _ in range(10)]
            for one in idle[:6]:
                assert one.recv(1) == b""
            assert page.ask("GET", "/state") == (200, b"there")
            own.say({})
            assert own.take() == "there"
    assert len(caplog.messages) == 1


HALF = [
    b"",
    b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n",
    b"POST /state HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n",
    b"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n",
    b"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\nGET / HT",
]


def test_who_shows_no_token_in_time_is_closed_and_who_has_shown_it_stays() -> None:
    now = [0.0]
    with serving(Door(clock=lambda: now[0])) as page, page.open("/board") as own:
        kept = http.client.HTTPConnection("127.0.0.1", page.port, timeout=HANGS_S)

        def ask() -> bytes:
            kept.request("GET", "/state", headers={"X-Greywhale-Token": TOKEN})
            return kept.getresponse().read()

        assert ask() == b"there"
        port = kept.sock.getsockname()
        halves = [connect(page, one.replace(b"{port}", str(page.port).encode())) for one in HALF]
        assert page.ask("GET", "/") == (200, b"there"), "all of them are known by now"
        now[0] = CONNECTIONS.patience_s + 1.0
        assert [rest(one).count(b"there") for one in halves] == [0, 0, 0, 1, 1]
        assert ask() == b"there"
        assert kept.sock.getsockname() == port, "it was the same connection"
        own.say({})
        assert own.take() == "there"
        kept.close()


def test_too_many_with_the_token_are_told_so() -> None:
    with serving(Door(most_known=2)) as page, page.open("/board"):
        with page.open("/host"):
            assert page.ask("GET", "/state") == (503, b"Too many pages are open; close some.")
        while page.ask("GET", "/state")[0] == 503:
            pass  # the server has not noticed yet that the other one went


def test_strangers_wait_for_each_other_and_the_owner_for_none_of_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guard, "REQUESTS", replace(REQUESTS, strangers=(0.0, 3.0)))
    request = b"%s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nConnection: close\r\n\r\n"
    asked = [b"GET /", b"GET /state", b"POST /enter", b"GET /", b"GET /state", b"POST /", b"HEAD /"]
    with serving(Door()) as page, page.open("/board") as own:
        strangers = [connect(page, request % (one, page.port)) for one in asked[:3]]
        assert [b"HTTP/1.1" in rest(one) for one in strangers] == 3 * [True]
        strangers = [connect(page, request % (one, page.port)) for one in asked[3:]]
        for _ in range(20):
            assert page.ask("GET", "/state") == (200, b"there")
        own.say({})
        assert own.take() == "there"
        assert select.select(strangers, [], [], 0)[0] == []
        for one in strangers:
            one.close()


def test_who_has_asked_for_something_has_its_time_before_others_come_in(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guard, "REQUESTS", replace(REQUESTS, strangers=(0.0, 0.0)))  # nobody is answered
    now = [0.0]
    with serving(Door(most_strangers=3, clock=lambda: now[0])) as page, page.open("/board") as own:
        said = [b"GET / HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n" % page.port, b"GET / HT", b"G"]
        first = [connect(page, one) for one in said]
        with connect(page), connect(page):  # these wait outside
            for _ in range(5):
                own.say({})
                assert own.take() == "there"
            assert select.select(first, [], [], 0)[0] == []
            now[0] = CONNECTIONS.grace_s + 1.0
            assert rest(first[0]) == b""
            assert page.ask("GET", "/state") == (200, b"there")
        for one in first[1:]:
            one.close()


def test_a_stranger_is_closed_for_another_one_alone() -> None:
    with serving(Door(most_strangers=1)) as page, page.open("/board") as own:
        slow = connect(page)
        for _ in range(5):  # meanwhile it is accepted
            own.say({})
            assert own.take() == "there"
        slow.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nConnection: close\r\n\r\n" % page.port)
        assert rest(slow).endswith(b"there")


def test_nobody_without_the_token_is_refused_for_others_requests(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guard, "REQUESTS", replace(REQUESTS, strangers=(1000.0, 2.0)))
    with serving(Door()) as page:
        assert [Page(page.port, "").ask("GET", "/")[0] for _ in range(50)] == 50 * [200]


class Poor(socket.socket):
    """A listener whose process has no descriptor left for so many connections, but for what it closes then."""

    failures = 0
    closed_one = False

    def accept(self) -> tuple[socket.socket, tuple[str, int]]:
        if self.failures and not self.closed_one:
            self.closed_one = True
            raise OSError(errno.EMFILE, os.strerror(errno.EMFILE))
        self.failures -= self.closed_one
        self.closed_one = False
        return super().accept()


def test_without_descriptors_it_closes_who_waits_and_says_so_once(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(connections, "CONNECTIONS", replace(CONNECTIONS, without_descriptors_s=0.0))
    listener = Poor()
    listener.bind(("127.0.0.1", 0))
    listener.listen()
    with serving(Door(), listener) as page, page.open("/board") as own:
        listener.failures = 3
        assert [rest(connect(page)) for _ in range(3)] == 3 * [b""]
        own.say({})
        assert own.take() == "there"
        assert page.ask("GET", "/state")[0] == 200
    assert [one.exc_info for one in caplog.records] == [None]


@pytest.mark.parametrize(
    ("owner", "user", "foreign"),
    [(1001, 1000, True), (1000, 1001, True), (1000, 1000, False), (0, 1000, False), (None, 1000, False), (7, 0, False)],
)
def test_another_users_connections_are_closed_where_the_system_tells(
    owner: int | None, user: int, foreign: bool, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(system, "user", lambda: user)
    monkeypatch.setattr(sockets, "owner_of", lambda end, other: owner)
    with serving(Door()) as page:
        said = [rest(connect(page, b"GET / HTTP/1.1\r\nConnection: close\r\n\r\n")) for _ in range(3)]
    assert [b"HTTP" in one for one in said] == 3 * [not foreign]
    assert len(caplog.messages) == foreign


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells")
@pytest.mark.parametrize("host", ["127.0.0.1", "::ffff:127.0.0.1"])
def test_the_system_tells_whose_a_connection_is(host: str) -> None:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with server.listen() as listener, socket.socket(family) as own:
        own.connect((host, listener.getsockname()[1]))
        accepted, end = listener.accept()
        with accepted:
            assert sockets.owner_of(end, accepted.getsockname()) == os.geteuid()
            assert sockets.owner_of(end, ("127.0.0.1", 1)) is None


def test_odd_requests_leave_no_line(caplog: pytest.LogCaptureFixture) -> None:
    with serving(Door()) as page:
        for said in (
            b"\0\n\r\n\r\n",
            b"GET\r\n\r\n",
            b"GET / HTTP/1.1\r\nHost: a\r\nConnection: upgrade\r\nUpgrade: x\r\n\r\n",
        ):
            assert b"HTTP/1.1 4" in rest(connect(page, said))
    assert caplog.messages == []
