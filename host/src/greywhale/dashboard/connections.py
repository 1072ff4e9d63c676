"""Accepts the connections of a server. Other users stay outside; strangers cost little and cause no traceback.

uvicorn spends 0.2 ms on a new connection, even on a silent one. So it is handed only connections that have sent
something, and only so many a second. A flood of connections delays new pages, but neither open ones nor the motors'
lease.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import os
import socket
from collections import deque

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from greywhale.base import sockets, system
from greywhale.dashboard.bucket import Bucket
from greywhale.dashboard.door import Door
from greywhale.dashboard.limits import CONNECTIONS

_AGAIN_S = 0.01  # until the next try, while the door or a bucket has no room
_ROOT = 0  # user id
_NO_DESCRIPTORS = (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM)


class Arrival:
    """One connection. uvicorn gets it when it has sent something."""

    def __init__(self, connection: socket.socket) -> None:
        self.connection = connection
        self._loop = asyncio.get_running_loop()
        self.has_spoken = self._handed = self._closed = False
        self._transport: asyncio.Transport | None = None
        self._protocol: asyncio.BaseProtocol | None = None

    @property
    def gone(self) -> bool:
        return self._closed or (self._transport is not None and self._transport.is_closing())

    @property
    def waits(self) -> bool:
        protocol = self._protocol
        if isinstance(protocol, H11Protocol):
            return protocol.cycle is None or not protocol.cycle.response_complete
        return self.has_spoken and protocol is None

    @property
    def busy(self) -> bool:
        protocol = self._protocol
        return isinstance(protocol, H11Protocol) and protocol.cycle is not None and not protocol.cycle.response_complete

    def close(self) -> None:
        self._closed = True
        if self._transport is not None:
            self._transport.abort()
        elif not self._handed:
            self._loop.remove_reader(self.connection)
            self.connection.close()

    def has_said(self) -> bytes | None:
        """The first byte that has come, left unread; b"" if the other side has closed, None while nothing has come."""
        try:
            return self.connection.recv(1, socket.MSG_PEEK)
        except BlockingIOError:
            return None
        except OSError:
            return b""

    async def hand(self, server: uvicorn.Server) -> None:
        """Hand it to uvicorn."""
        self._handed = True

        def make() -> asyncio.Protocol:
            return server.config.http_protocol_class(  # type: ignore[call-arg]
                config=server.config, server_state=server.server_state, app_state=server.lifespan.state
            )

        self._transport, self._protocol = await self._loop.connect_accepted_socket(make, self.connection)
        if self._closed:
            self._transport.abort()


class Server(uvicorn.Server):
    """A uvicorn server that accepts only connections for which its door has room."""

    def __init__(self, config: uvicorn.Config, door: Door) -> None:
        super().__init__(config)
        self._door = door
        self._listener: socket.socket | None = None
        self._reserve = -1  # a descriptor to free when the system has no others left
        self._spoken: deque[Arrival] = deque()
        self._accepted = Bucket(*CONNECTIONS.accepted)
        self._handed = Bucket(*CONNECTIONS.handed)
        self._handing: set[asyncio.Task[None]] = set()

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen at one socket. On Windows, where asyncio waits for no plain sockets, uvicorn accepts by itself."""
        await super().startup([] if system.WAITS_FOR_SOCKETS else sockets)
        if system.WAITS_FOR_SOCKETS and sockets:
            [self._listener] = sockets
            self._listener.setblocking(False)
            self._listener.listen(CONNECTIONS.backlog)
            self._reserve = os.open(os.devnull, os.O_RDONLY)
            self._listen()

    async def on_tick(self, counter: int) -> bool:
        self._door.look()
        return await super().on_tick(counter)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        if self._listener is not None:
            asyncio.get_running_loop().remove_reader(self._listener)
            self._listener = None
            os.close(self._reserve)
        self._door.close_strangers()
        await super().shutdown(sockets)

    def _listen(self) -> None:
        if self._listener is not None:
            asyncio.get_running_loop().add_reader(self._listener, self._accept, self._listener)

    def _rest(self, pause_s: float) -> None:
        """Accept no connection during a pause."""
        loop = asyncio.get_running_loop()
        if self._listener is not None:
            loop.remove_reader(self._listener)
            loop.call_later(pause_s, self._listen)

    def _accept(self, listener: socket.socket) -> None:
        """Accept the first waiting connection, and only that one: the door has made room for one."""
        if not (self._door.make_room() and self._accepted.take()):
            self._rest(_AGAIN_S)
            return
        try:
            connection, address = listener.accept()
        except (BlockingIOError, ConnectionAbortedError):
            return
        except OSError as error:
            if error.errno not in _NO_DESCRIPTORS:
                raise
            self._door.log_once("the system has no descriptors left for connections; new pages wait for some.")
            if not self._door.keep_fewer():
                self._spend_reserve(listener)
            return
        if is_foreign(connection):
            self._door.log_once("another user of this machine tried to connect to the dashboard, and was refused.")
            connection.close()
            return
        connection.setblocking(False)
        arrival = Arrival(connection)
        self._door.enter(address, arrival)
        self._hear(arrival)  # it may have sent something while it waited

    def _spend_reserve(self, listener: socket.socket) -> None:
        """Close the first waiting connection by means of the spare descriptor, and let the others wait."""
        os.close(self._reserve)
        with contextlib.suppress(OSError):
            listener.accept()[0].close()
        self._reserve = os.open(os.devnull, os.O_RDONLY)
        self._rest(CONNECTIONS.without_descriptors_s)

    def _hear(self, arrival: Arrival) -> None:
        """Note that a connection has sent something, or has ended; else wait for either."""
        loop = asyncio.get_running_loop()
        loop.remove_reader(arrival.connection)
        said = arrival.has_said()
        if said is None:
            loop.add_reader(arrival.connection, self._hear, arrival)
        elif said:
            arrival.has_spoken = True
            self._spoken.append(arrival)
            if len(self._spoken) == 1:
                self._hand()
        else:
            arrival.close()

    def _hand(self) -> None:
        """Hand the connections that have sent something to uvicorn in their order; new ones wait meanwhile."""
        loop = asyncio.get_running_loop()
        while self._spoken and (self._spoken[0].gone or self._handed.take()):
            arrival = self._spoken.popleft()
            if not arrival.gone:
                task = loop.create_task(arrival.hand(self))
                self._handing.add(task)
                task.add_done_callback(self._handing.discard)
        if self._spoken:
            self._rest(_AGAIN_S)
            loop.call_later(_AGAIN_S, self._hand)


def is_foreign(connection: socket.socket) -> bool:
    """True if another user is at the other end, as far as the system tells.

    Root gets in: it may read this process anyway, and forwards ports for others (containers). Where root itself serves,
    its browser may run as another user, so nobody is foreign.
    """
    user = system.user()
    if user == _ROOT:
        return False
    try:
        ends = connection.getpeername(), connection.getsockname()
    except OSError:  # it has ended
        return False
    return sockets.owner_of(*ends) not in (None, _ROOT, user)
