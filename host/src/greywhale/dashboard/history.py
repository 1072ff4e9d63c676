"""The board's last samples, as the frames that they came in."""

from __future__ import annotations

import threading

import numpy as np

from greywhale.base.types import Integers
from greywhale.dashboard.limits import SAMPLES
from greywhale.protocol import schema
from greywhale.protocol.frames import OVERHEAD

# COBS adds one byte to so short a frame whatever it holds, and the zero ends it: all samples are equally long.
FRAME_BYTES = schema.Sample.SIZE + OVERHEAD + 2


class History:
    """A ring of sample frames; one thread adds to it, and any may read."""

    def __init__(self, most: int = SAMPLES.history) -> None:
        self._most = most
        self._frames = bytearray(most * FRAME_BYTES)
        self._ticks: Integers = np.zeros(most, dtype=np.uint32)
        self._added = 0  # samples, ever
        self._begun = 0  # of them before the board last started
        self._lock = threading.Lock()

    def add(self, tick: int, frame: bytes) -> None:
        """Keep a frame of `FRAME_BYTES`; a tick before the last one tells that the board has started anew."""
        with self._lock:
            place = self._added % self._most
            if self._added and tick < self._ticks[place - 1]:
                self._begun = self._added
            self._ticks[place] = tick
            self._frames[place * FRAME_BYTES : (place + 1) * FRAME_BYTES] = frame
            self._added += 1

    def since(self, tick: int | None) -> bytes:
        """All frames kept, oldest first; with a `tick` those from it on, since the board last started."""
        with self._lock:
            first = max(0, self._added - self._most)
            if tick is not None:
                first = max(first, self._begun)
                ticks = self._ticks[np.arange(first, self._added) % self._most]
                first += int(np.searchsorted(ticks, tick))
            count = self._added - first
            begin = first % self._most
            end = min(self._most, begin + count)
            rest = count - (end - begin)
            frames = memoryview(self._frames)  # so that all is copied once
            return b"".join((frames[begin * FRAME_BYTES : end * FRAME_BYTES], frames[: rest * FRAME_BYTES]))
