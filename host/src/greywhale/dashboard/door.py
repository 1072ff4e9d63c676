"""Knows all connections: those that have shown the token, and strangers, of whom few may stay, and not for long.

A stranger can neither keep the owner out nor use up the server's descriptors: when one too many comes, an older one
is closed, or the new one waits until one has had its time.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from greywhale.dashboard.limits import CONNECTIONS

Address = tuple[str, int]
logger = logging.getLogger(__name__)


class Visitor(Protocol):
    """One connection."""

    @property
    def gone(self) -> bool:
        """True if it is closed, or about to be."""

    @property
    def waits(self) -> bool:
        """True if it has said something, and has not got a whole answer yet."""

    @property
    def busy(self) -> bool:
        """True if it has asked for something, of which not all has gone out yet."""

    def close(self) -> None:
        """Close it at once, whatever was still to be sent."""


@dataclass
class _Stranger:
    visitor: Visitor
    since_s: float


class Door:
    """All connections of a server, by the address at their other end. Used in the server's own thread alone."""

    def __init__(
        self,
        most_strangers: int = CONNECTIONS.most_strangers,
        most_known: int = CONNECTIONS.most_known,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._most_strangers, self._most_known, self._clock = most_strangers, most_known, clock
        self._strangers: dict[Address, _Stranger] = {}  # the oldest first
        self._known: dict[Address, Visitor] = {}
        self._logged: set[str] = set()

    def make_room(self) -> bool:
        """Return True if one more may enter; where strangers are too many, close one of them for it.

        Closed is the oldest that has had a moment to say something and waits for no answer; if all wait, the oldest
        that has had its time. While there is neither, the new one has to wait.
        """
        self._forget_gone()
        if len(self._strangers) < self._most_strangers:
            return True
        self.log_once(f"more than {self._most_strangers} connections show no token; the oldest of them are closed.")
        now_s = self._clock()
        strangers = self._strangers.values()
        waiting_for_nothing = [
            one.visitor for one in strangers if one.since_s <= now_s - CONNECTIONS.moment_s and not one.visitor.waits
        ]
        here_long_enough = [one.visitor for one in strangers if one.since_s <= now_s - CONNECTIONS.grace_s]
        may_go = [*waiting_for_nothing, *here_long_enough]
        if not may_go:
            return False
        may_go[0].close()
        self._forget_gone()
        return True

    def enter(self, address: Address, visitor: Visitor) -> None:
        """Take in a new connection, as a stranger."""
        self._strangers[address] = _Stranger(visitor, self._clock())

    def keep_fewer(self) -> bool:
        """Let half as many strangers stay from now on, as the system has no descriptors left; False where few do."""
        self._forget_gone()
        self._most_strangers = max(CONNECTIONS.fewest_strangers, len(self._strangers) // 2)
        too_many = list(self._strangers.values())[: -self._most_strangers]
        for stranger in too_many:
            stranger.visitor.close()
        return bool(too_many)

    def welcome(self, address: Address) -> bool:
        """Make a stranger that has shown the token a known one; False where too many others are known."""
        stranger = self._strangers.get(address)
        if stranger is None:
            return True
        self._forget_gone()
        if len(self._known) >= self._most_known:
            return False
        self._known[address] = stranger.visitor
        self._strangers.pop(address, None)
        return True

    def is_there(self, address: Address) -> bool:
        """True if this stranger is still connected."""
        stranger = self._strangers.get(address)
        return stranger is not None and not stranger.visitor.gone

    def look(self) -> None:
        """Close the strangers that had their time and wait for no answer."""
        self._forget_gone()
        then_s = self._clock() - CONNECTIONS.patience_s
        for stranger in self._strangers.values():
            if stranger.since_s < then_s and not stranger.visitor.busy:
                stranger.visitor.close()

    def close_strangers(self) -> None:
        """Close all strangers, at the server's end."""
        for stranger in self._strangers.values():
            stranger.visitor.close()

    def log_once(self, sentence: str) -> None:
        """Write a line into the log, once: a client that is refused may come again a thousand times a second."""
        if sentence not in self._logged:
            self._logged.add(sentence)
            logger.warning(sentence)

    def _forget_gone(self) -> None:
        self._strangers = {one: stranger for one, stranger in self._strangers.items() if not stranger.visitor.gone}
        self._known = {one: visitor for one, visitor in self._known.items() if not visitor.gone}
