"""The server's end of a line that is lent to a verb: its frames go through the relay, as a page's do."""

from __future__ import annotations

import selectors
import socket

from greywhale.dashboard.client import Client
from greywhale.dashboard.relay import Relay, Wish
from greywhale.protocol.socket_line import PIECE_BYTES


class LentEnd:
    """Never waits: whoever calls it selects on `connection`."""

    def __init__(self, relay: Relay, connection: socket.socket, client: Client, wish: Wish) -> None:
        """A UserError says why the verb, a client that may get the limit's `lent` samples, is not to begin."""
        self._relay = relay
        self._connection = connection
        connection.setblocking(False)
        self._client = client
        self._waiting = b""
        self._open = True
        relay.join(client, wish)

    def forbid(self) -> None:
        """The verb is stopped: it starts no motor from now on."""
        self._relay.forbid(self._client)

    def register(self, selector: selectors.BaseSelector) -> None:
        selector.register(self._connection, selectors.EVENT_READ)

    def serve(self, selector: selectors.BaseSelector, events: int) -> None:
        """Take what the verb sent."""
        if events & selectors.EVENT_READ:
            try:
                data = self._connection.recv(PIECE_BYTES)
            except BlockingIOError:
                return
            except OSError:
                data = b""
            if data:
                self._relay.receive(self._client, data)
            else:
                selector.unregister(self._connection)
                self.close()

    def pass_on(self, selector: selectors.BaseSelector) -> None:
        """Send the verb what waits for it, as far as it takes it."""
        while self._open:
            if not self._waiting:
                answers, samples = self._client.outbox.take()
                if any(isinstance(one, dict) for one in answers):  # the board is gone
                    selector.unregister(self._connection)
                    self.close()
                    return
                self._waiting = b"".join(one for one in answers if isinstance(one, bytes)) + samples
            if not self._waiting:
                break
            try:
                sent = self._connection.send(self._waiting)
            except BlockingIOError:
                break
            except OSError:
                return
            self._waiting = self._waiting[sent:]
        if self._open:
            wanted = selectors.EVENT_READ | (selectors.EVENT_WRITE if self._waiting else 0)
            selector.modify(self._connection, wanted)

    def close(self) -> None:
        """The verb has the board no more: what it started is stopped."""
        if self._open:
            self._open = False
            self._relay.leave(self._client)
            self._connection.close()
