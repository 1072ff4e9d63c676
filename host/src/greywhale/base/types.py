"""Types that all rooms share: arrays, and what a long piece of work tells of its progress."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Integers = NDArray[np.int32]
Controllers = NDArray[np.int32]  # (4, 13), or (n, 4, 13) for n sets: columns as in `protocol.table.CONTROLLER_COLUMNS`

# Answers in JSON are typed: comments behind their keys and pairs in Annotated go into the JSON schemas.
Value = TypeVar("Value")
PerJoint = Annotated[list[Value], ("minItems", 4), ("maxItems", 4)]
Crc = Annotated[str, ("pattern", "^0x[0-9a-f]{4}$")]  # of parameters

Progress = Callable[[str, float], None]  # takes what is being done, and the share of it that is done


class NotedProgress(Protocol):
    """Progress with a note, such as the best cost."""

    def __call__(self, what: str, fraction: float, note: str = "") -> None: ...


def show_no_progress(what: str, fraction: float, note: str = "") -> None:
    """For callers whom nobody watches."""
