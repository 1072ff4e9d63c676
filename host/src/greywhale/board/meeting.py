"""The meeting place of a session and those who want to stop it: a name that follows from the user and the port alone.

Neither the environment nor a folder counts, so a notebook, a cron job and `su -` all lead to the same place. The name
is one of Linux's abstract sockets: it is no file, which somebody could remove, and it ends with its process. It also
keeps this user's other sessions out while a session holds a port that it has not open (an open one would keep DTR up,
so that nothing could restart the board). Any user may take a name first. So both ends look whose the other is, and
there are some names.
"""

from __future__ import annotations

import contextlib
import errno
import os
import socket
import time
from collections.abc import Container, Iterator
from typing import NamedTuple

from greywhale.base import sockets, system
from greywhale.base.errors import UserError
from greywhale.board.limits import PATIENCE
from greywhale.protocol.holder import describe
from greywhale.protocol.lines import device_of

STOP, CLUTCH = "stop", ("engage", "disengage")  # what a client may say
NAMES_PER_PORT = 8  # any user may take some of them first


class Peer(NamedTuple):
    """The process at the other end, and its user."""

    pid: int
    uid: int

    @property
    def ours(self) -> bool:
        return self.uid == system.user()


def peer_of(connection: socket.socket) -> Peer:
    """The user at the other end, by the system's word."""
    return Peer(*sockets.peer_of(connection))


def names_of(device: str) -> list[str]:
    """The names at which this user's session on a device may listen."""
    return [f"\0greywhale/{system.user()}/{device}/{number}" for number in range(NAMES_PER_PORT)]


def listen(port: str, device: str) -> socket.socket:
    """Listen for this user. A UserError where another session of this user has the port, an OSError without a name."""
    for name in names_of(device):
        listener = sockets.abstract_socket()
        try:
            taken = not _take(listener, name)
            _refuse_second(port, device)
        except BaseException:
            listener.close()
            raise
        if not taken:
            return listener
        listener.close()
    takers = sorted({f"process {peer.pid} of user {peer.uid}" for peer in _listeners(device)})
    raise OSError(errno.EADDRINUSE, f"{', '.join(takers) or 'another user'} has taken all names for it")


def _take(listener: socket.socket, name: str) -> bool:
    try:
        listener.bind(name)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            return False
        raise
    listener.listen(PATIENCE.most_clients)
    listener.setblocking(False)
    return True


def _listeners(device: str) -> Iterator[Peer]:
    with contextlib.suppress(BlockingIOError):
        for client, peer in _connections(device):
            client.close()
            yield peer


def _refuse_second(port: str, device: str) -> None:
    for peer in _listeners(device):
        if peer.ours and peer.pid != os.getpid():
            raise UserError(
                f"{port}: the port is in use by another greywhale, {describe(peer.pid)}; wait for its end, or stop "
                f"it with `greywhale stop --port {port}`."
            )


def find(port: str, patience_s: float) -> tuple[socket.socket, Peer] | None:
    """A connection to this user's session on a port, None where there is none.

    Where others crowd a name, it is tried again until the patience ends.
    """
    device = device_of(port) if sockets.HAS_ABSTRACT_SOCKETS else None
    end = time.monotonic() + patience_s
    while device is not None:
        try:
            for client, peer in _connections(device):
                if peer.ours:
                    return client, peer
                client.close()
            return None
        except BlockingIOError:
            if time.monotonic() > end:
                return None
        time.sleep(0.01)  # the listener is full
    return None


def _connections(device: str) -> Iterator[tuple[socket.socket, Peer]]:
    """Every one who listens at a device's names, of whatever user; at last BlockingIOError where a door was crowded."""
    crowded = None
    for name in names_of(device):
        client = sockets.abstract_socket()
        client.setblocking(False)
        try:
            client.connect(name)
            peer = peer_of(client)
        except OSError as error:  # mostly because nobody listens
            client.close()
            crowded = error if isinstance(error, BlockingIOError) else crowded
        else:
            yield client, peer
    if crowded is not None:
        raise crowded


class Clients:
    """The clients of a listener. None of them is waited for."""

    def __init__(self, listener: socket.socket) -> None:
        self._listener = listener
        self._silent: list[socket.socket] = []
        self.asking: list[socket.socket] = []  # for a stop
        self.clutching: list[tuple[str, socket.socket]] = []  # what the clutch is to do; who takes one closes it
        self._answered: list[socket.socket] = []

    def descriptors(self) -> list[int]:
        """The descriptors to watch for something to hear."""
        return [one.fileno() for one in (self._listener, *self._silent)]

    def hear(self, ready: Container[int]) -> bool:
        """True if one of those who are `ready` asks for a stop; also let a newcomer in."""
        stops = False
        for client in [client for client in self._silent if client.fileno() in ready]:
            self._silent.remove(client)
            word = _word(client)
            if word == STOP:
                stops = True
                self.asking.append(client)
            elif word in CLUTCH:
                self.clutching.append((word, client))
            else:
                client.close()
        if self._listener.fileno() in ready:
            self._silent += _accept(self._listener)
        if len(self._silent) > PATIENCE.most_clients:
            self._silent.pop(0).close()
        return stops

    def answer(self, line: bytes) -> None:
        for client in self.asking:
            with contextlib.suppress(OSError):  # it has gone, or has not read for long
                client.send(line)
        self._answered += self.asking
        self.asking = []

    def close(self) -> None:
        clutching = [client for _, client in self.clutching]
        for one in (self._listener, *self._silent, *self.asking, *clutching, *self._answered):
            one.close()


def _word(client: socket.socket) -> str:
    """A client's request, empty where that is unknown; a request for a stop is confirmed at once."""
    try:
        word = client.recv(16).partition(b"\n")[0].decode("ascii", "replace")
    except OSError:
        return ""
    if word == STOP:
        with contextlib.suppress(OSError):  # whether it still listens or not
            client.send(b"\n")
    return word


def _accept(listener: socket.socket) -> list[socket.socket]:
    """A client of this user; none where it is another's, or has gone again."""
    try:
        client, _ = listener.accept()
    except OSError:
        return []
    if not peer_of(client).ours:
        client.close()
        return []
    client.setblocking(False)
    return [client]
