"""Lets a page in: by the server's token, or by a ticket, which an address carries in its place.

A browser keeps addresses: in its history, among the most visited pages, in the files from which it opens its tabs
again. A ticket counts once and not for long, so what is kept is worth nothing.
"""

from __future__ import annotations

import hmac
import secrets
import threading
import time
from collections.abc import Callable

from greywhale.dashboard.limits import REQUESTS

ANEW = "press Enter in the terminal of `greywhale dashboard`, and open the address that it prints then."
_SECRET_BYTES = 24  # of a token or a ticket: nobody guesses 192 bits


class Access:
    """That of the server at this port of the loopback. Any thread may call it."""

    def __init__(self, port: int, clock: Callable[[], float] = time.monotonic) -> None:
        self.token = secrets.token_urlsafe(_SECRET_BYTES)
        self._port, self._clock = port, clock
        self._tickets: dict[str, float] = {}  # and when they were made
        self._lock = threading.Lock()

    def address(self) -> str:
        """One to open in a browser, with a new ticket."""
        ticket = secrets.token_urlsafe(_SECRET_BYTES)
        with self._lock:
            self._tickets[ticket] = self._clock()
            for oldest in list(self._tickets)[: -REQUESTS.most_tickets]:
                del self._tickets[oldest]
        return f"http://127.0.0.1:{self._port}/#ticket={ticket}"

    def exchange(self, ticket: str) -> str | None:
        """The token for a ticket, which is void from now on; None for one that is void."""
        with self._lock:
            known = next((one for one in self._tickets if hmac.compare_digest(one.encode(), ticket.encode())), None)
            if known is None or self._clock() > self._tickets.pop(known) + REQUESTS.ticket_lasts_s:
                return None
        return self.token
