"""A source of random numbers whose numbers the test has written down."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from greywhale.base.types import Floats


class Scripted:
    """Hands out the given arrays in order, and insists on the shapes asked for."""

    def __init__(self, *numbers: ArrayLike) -> None:
        self._numbers = [np.asarray(one, dtype=float) for one in numbers]

    def random(self, size: tuple[int, ...], /) -> Floats:
        assert self._numbers, f"the script has ended, but {size} more numbers are wanted"
        number = self._numbers.pop(0)
        assert number.ndim == 0 or number.shape == size, f"{size} wanted, the script has {number.shape}"
        return np.broadcast_to(number, size).copy()

    @property
    def used_up(self) -> bool:
        return not self._numbers
