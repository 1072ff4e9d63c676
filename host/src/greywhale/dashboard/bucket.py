"""A bound on how often something may be done."""

from __future__ import annotations

import time
from collections.abc import Callable


class Bucket:
    """So many a second, and so many at once."""

    def __init__(self, a_second: float, at_once: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._a_second, self._most, self._clock = a_second, at_once, clock
        self._left, self._then_s = at_once, clock()

    def take(self) -> bool:
        """Take one; False if none is left."""
        now_s = self._clock()
        self._left = min(self._most, self._left + (now_s - self._then_s) * self._a_second)
        self._then_s = now_s
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
