"""Who is connected: those who have shown the token, and strangers, of whom few may stay, and not for long.

A stranger can neither keep the owner out nor use up the server's descriptors: when one too many comes, an older one
is closed.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from greywhale.dashboard.bucket import Bucket

# A page that loads opens six connections without the token, and some browsers a few more for later.
MOST_STRANGERS = 64
MOST_KNOWN = 64  # a page has two, and a moment's more for what it asks
# A browser that opens a connection beforehand may use it seconds later.
PATIENCE_S = 10.0
# Of one connection without the token. A page that loads asks for some ten files.
REQUESTS_A_SECOND, AT_ONCE = 20.0, 60.0

Address = tuple[str, int]
logger = logging.getLogger(__name__)


class Visitor(Protocol):
    """One connection."""

    @property
    def gone(self) -> bool:
        """Whether it is closed, or about to be."""

    @property
    def busy(self) -> bool:
        """Whether it has asked for something and not got all of it yet."""

    def close(self) -> None:
        """Close it at once, whatever was still to be sent."""


@dataclass
class _Stranger:
    visitor: Visitor
    since_s: float
    requests: Bucket


class Door:
    """All connections of a server, by the address at their other end. Used in the server's own thread alone."""

    def __init__(
        self,
        most_strangers: int = MOST_STRANGERS,
        most_known: int = MOST_KNOWN,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._most_strangers, self._most_known, self._clock = most_strangers, most_known, clock
        self._strangers: dict[Address, _Stranger] = {}  # the oldest first
        self._known: dict[Address, Visitor] = {}
        self._told: set[str] = set()

    def enter(self, address: Address, visitor: Visitor) -> None:
        """A connection begins. Where there are too many strangers, the oldest is closed that waits for no answer."""
        self._forget_gone()
        if len(self._strangers) >= self._most_strangers:
            self.tell(f"more than {self._most_strangers} connections show no token; the oldest of them are closed.")
            idle = (one for one, stranger in self._strangers.items() if not stranger.visitor.busy)
            self._strangers.pop(next(idle, next(iter(self._strangers)))).visitor.close()
        self._strangers[address] = _Stranger(visitor, self._clock(), Bucket(REQUESTS_A_SECOND, AT_ONCE, self._clock))

    def welcome(self, address: Address) -> bool:
        """It has shown the token; False where too many others have."""
        stranger = self._strangers.get(address)
        if stranger is None:
            return True
        self._forget_gone()
        if len(self._known) >= self._most_known:
            return False
        self._known[address] = stranger.visitor
        self._strangers.pop(address, None)
        return True

    def may_ask(self, address: Address) -> bool:
        """Whether it may ask for something without the token now."""
        stranger = self._strangers.get(address)
        return stranger is None or stranger.requests.take()

    def look(self) -> None:
        """Close the strangers that had their time and wait for no answer."""
        self._forget_gone()
        then_s = self._clock() - PATIENCE_S
        for stranger in self._strangers.values():
            if stranger.since_s < then_s and not stranger.visitor.busy:
                stranger.visitor.close()

    def close_strangers(self) -> None:
        """Nobody waits for them any more."""
        for stranger in self._strangers.values():
            stranger.visitor.close()

    def tell(self, sentence: str) -> None:
        """A line in the log, once: whoever comes in vain may come again a thousand times a second."""
        if sentence not in self._told:
            self._told.add(sentence)
            logger.warning(sentence)

    def _forget_gone(self) -> None:
        self._strangers = {one: stranger for one, stranger in self._strangers.items() if not stranger.visitor.gone}
        self._known = {one: visitor for one, visitor in self._known.items() if not visitor.gone}
