"""The most that the drivers' pins have asked for: tells if a motor was ever driven too hard, or for too long."""

from __future__ import annotations

from collections.abc import Sequence


class PinsSeen:
    """Looks at every change of the pins; `duties` is the highest of each driver while they were enabled."""

    def __init__(self) -> None:
        self.duties = [0.0] * 4
        self._longest = 0  # cycles
        self._on_since: int | None = None

    def look(self, cycle: int, enabled: bool, duties: Sequence[float]) -> None:
        """Note the pins as they are from this cycle on."""
        if not enabled:
            self._longest = self.longest(cycle)
            self._on_since = None
            return
        if self._on_since is None:
            self._on_since = cycle
        for driver, duty in enumerate(duties):
            if duty > self.duties[driver]:
                self.duties[driver] = duty

    def longest(self, cycle: int) -> int:
        """The most cycles that the drivers were enabled without a break, up to this cycle."""
        return max(self._longest, 0 if self._on_since is None else cycle - self._on_since)
