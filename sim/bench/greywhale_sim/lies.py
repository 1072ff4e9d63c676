"""Mistakes between the potentiometers and the converter: swapped wires, slipping shafts, loose contacts."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

KINDS = ("frozen", "slipping", "loose")
SLIPS = 0.3  # of every way up is lost, so that the same angle reads lower each time
LOOSE_EVERY, LOOSE_FOR = 920, 8  # slices: a wire with a pull-down is off for 2 ms in 230 ms
SUPPLY_MV, NOISE_MV = 5000.0, 30.0


class Lies:
    """Changes the eight voltages (mV) of a slice; `any` tells whether there is anything to change."""

    def __init__(self) -> None:
        self.order = list(range(8))  # which potentiometer is on each input
        self._kinds: dict[int, str] = {}
        self._last: dict[int, tuple[float, float]] = {}  # pot -> what it had, what it showed
        self._slice = 0
        self.any = False

    def stage(self, pot: int, kind: str | None) -> None:
        """Let potentiometer 0..7 (leader, follower) lie in this way from now on; None: it tells the truth again."""
        self._kinds.pop(pot, None)
        self._last.pop(pot, None)
        if kind is not None:
            self._kinds[pot] = kind
        self._look()

    def swap(self, one: int, other: int) -> None:
        """Exchange the wires of two inputs."""
        self.order[one], self.order[other] = self.order[other], self.order[one]
        self._look()

    def apply(self, millivolts: Array) -> None:
        """Change the voltages in place, once a slice."""
        self._slice += 1
        for pot, kind in self._kinds.items():
            true = float(millivolts[pot])
            had, shown = self._last.get(pot, (true, true))
            if kind == "loose":
                shown = 0.0 if self._slice % LOOSE_EVERY < LOOSE_FOR else true
            elif kind == "slipping":
                way = true - had
                if abs(way) < NOISE_MV:  # does not move the shaft
                    millivolts[pot] = min(max(shown + way, 0.0), SUPPLY_MV)
                    self._last[pot] = (had, shown)
                    continue
                shown += way * (1.0 - SLIPS) if way > 0.0 else way
            self._last[pot] = (true, shown)
            millivolts[pot] = min(max(shown, 0.0), SUPPLY_MV)
        millivolts[:] = millivolts[self.order]

    def _look(self) -> None:
        self.any = bool(self._kinds) or self.order != list(range(8))
