"""Types that all rooms share: arrays, and what a long piece of work tells of its progress."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int32]
Controllers = NDArray[np.int32]  # (4, 13), or (n, 4, 13) for n sets: columns as in `protocol.table.CONTROLLER_COLUMNS`


Progress = Callable[[str, float], None]  # takes what is being done, and the share of it that is done


class NotedProgress(Protocol):
    """The same with a note, such as the best cost."""

    def __call__(self, what: str, fraction: float, note: str = "") -> None: ...


def show_no_progress(what: str, fraction: float, note: str = "") -> None:
    """For callers whom nobody watches."""
