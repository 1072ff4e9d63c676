"""Changes the set that the board runs, while a person works with the arm.

The firmware takes a set over only with the motors off. So a change needs a rest of the leader with a small error: all
parameters are staged before, while the motors run; then the motors are off for some 20 ms and come back within
SOFT_START_MS. Friction holds the arm meanwhile, and the integrals go on, as after every stop of less than 64 ms.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

import numpy as np

from greywhale.adapt.limits import ADAPTATION_LIMITS, ChangeLimits
from greywhale.board.device import Device
from greywhale.board.limits import RECORDING
from greywhale.board.stream import Received
from greywhale.board.upload import apply_staged, staging
from greywhale.protocol.firmware import ANGLE_LSB
from greywhale.protocol.table import ParameterTable

# The soft start of a set that runs for now, the shortest that the firmware takes; a stored set keeps its own.
SOFT_START_MS = 100


class RestWatch:
    """Sees every sample, and knows whether leader and follower rest close to each other."""

    def __init__(self, limits: ChangeLimits = ADAPTATION_LIMITS.changes) -> None:
        self._limits = limits
        self._seen: deque[tuple[int, ...]] = deque(maxlen=limits.rest_samples // limits.look_every_samples)
        self._count = 0
        self.error = np.inf  # the largest, rad

    def take(self, received: Received) -> None:
        self._count += 1
        if self._count % self._limits.look_every_samples == 0:
            sample = received.sample
            self._seen.append((*sample.leader, *sample.follower))
            self.error = ANGLE_LSB * max(abs(a - b) for a, b in zip(sample.leader, sample.follower, strict=True))

    @property
    def resting(self) -> bool:
        full = len(self._seen) == self._seen.maxlen
        still = self._limits.still_rad / ANGLE_LSB
        return full and self.is_close and bool(np.ptp(np.array(self._seen), axis=0).max() < still)

    @property
    def is_close(self) -> bool:
        """True where every error is so small that a change would not leave the arm behind."""
        return bool(self.error < self._limits.close_rad)


class SetChanger:
    """Stages a set in the background of a stream of samples, and lets the board run it when asked."""

    def __init__(self, device: Device, limits: ChangeLimits = ADAPTATION_LIMITS.changes) -> None:
        self._device, self._limits = device, limits
        self._table: ParameterTable | None = None
        self._staging: Iterator[int] = iter(())
        self._staged = 0
        self._count = 0

    def prepare(self, table: ParameterTable) -> None:
        """Call it with every sample: stage this set, bit by bit."""
        if self._table is None or self._table.crc != table.crc:
            self._table, self._staging, self._staged = table, staging(self._device, table), 0
        self._count += 1
        if self._count % self._limits.stage_every_samples == 0:
            self._staged = next(self._staging, self._staged)

    def is_ready(self, table: ParameterTable) -> bool:
        """True where this set is staged as a whole."""
        return self._table is not None and self._table.crc == table.crc and self._staged == len(table.raw)

    def change(self) -> None:
        """Motors off, the staged set runs, motors on."""
        assert self._table is not None
        self._device.stop()
        apply_staged(self._device, self._table)
        self._device.enable(RECORDING.busy_lease_ms)
        # What the board has staged now is not known for certain.
        self._table = None
