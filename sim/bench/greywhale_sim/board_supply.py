"""A board on the motors' own supply, without a large capacitor: when a motor draws, it sinks and the chip stops."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import numpy.typing as npt

FULL_MV, SUNK_MV = 5000, 2400  # below 2.7 V the brown-out detector holds the chip in reset
ENOUGH_V = 1.0  # at a motor: its current pulls the supply down
SUNK_SLICES = 120  # 30 ms, until the regulator is back


class Supplied(Protocol):
    """The part of the board that this needs."""

    def set_supply(self, millivolts: int, seed: int = 1) -> None: ...


class SharedSupply:
    """Looks at the motors once a slice, and lets the board's supply sink when one of them draws."""

    def __init__(self, board: Supplied) -> None:
        self._board = board
        self._left = 0

    def look(self, voltages: npt.NDArray[np.float64]) -> None:
        if self._left:
            self._left -= 1
            if self._left == 0:
                self._board.set_supply(FULL_MV)
        elif np.abs(voltages).max() > ENOUGH_V:
            self._left = SUNK_SLICES
            self._board.set_supply(SUNK_MV)

    def mend(self) -> None:
        """Give the board its own supply again."""
        if self._left:
            self._board.set_supply(FULL_MV)
            self._left = 0
