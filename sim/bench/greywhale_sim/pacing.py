"""Paces simulated time: in real time, or as fast as the machine and the host on the serial port can go.

As fast as possible has three exceptions. A bootloader and the host's flashing tool wait for each other by the clock, so
a bootloader whose host is silent waits in real time. A bench to which nobody is connected idles in real time. Time
stands still while the host has not yet read what the board sent, so that it is never seconds behind the board.
"""

from __future__ import annotations

import time
from collections.abc import Callable

UNREAD_LIMIT = 1024  # bytes: about 30 samples of telemetry
GIVE_UP_S = 0.05  # a longer lag (the machine was busy) is not made up for
SILENCE_S = 0.05  # a bootloader takes 30 ms to take in a page and to write it


def wants_real_time(
    fast: bool, connected: bool, in_bootloader: bool, host_baud: float, bootloader_baud: float, silent_s: float
) -> bool:
    """True while simulated time must keep to the wall clock; the line has been `silent_s` without a byte."""
    at_bootloader = in_bootloader and host_baud == bootloader_baud
    return not fast or not connected or (at_bootloader and silent_s > SILENCE_S)


class Pacer:
    """Keeps simulated time from running ahead of the wall clock; a slow machine falls behind, and that is counted."""

    def __init__(self, clock: Callable[[], float] = time.monotonic, wait: Callable[[float], None] = time.sleep) -> None:
        self._clock = clock
        self._wait = wait
        self._origin: tuple[float, float] | None = None  # simulated and wall time that belong together
        self._rate = 1.0
        self.lag_s = 0.0

    @property
    def rate(self) -> float:
        """Simulated seconds a second: 1 is real time, less is slow motion."""
        return self._rate

    @rate.setter
    def rate(self, rate: float) -> None:
        self._rate, self._origin = rate, None

    def pace(self, simulated_s: float, real_time: bool) -> None:
        """Call after every piece of simulation with the simulated time reached."""
        if not real_time:
            self._origin = None
            return
        now = self._clock()
        if self._origin is None:
            self._origin = (simulated_s, now)
            return
        ahead = (simulated_s - self._origin[0]) / self._rate - (now - self._origin[1])
        if ahead > 0.0:
            self._wait(ahead)
        elif ahead < -GIVE_UP_S:
            self.lag_s -= ahead
            self._origin = (simulated_s, now)

    def drain(self, backlog: Callable[[int], int], keep_waiting: Callable[[], bool]) -> None:
        """Hold simulated time until the host has read enough; `keep_waiting` ends the wait when the host is gone."""
        while backlog(UNREAD_LIMIT) > UNREAD_LIMIT and keep_waiting():
            self._wait(0.0001)
