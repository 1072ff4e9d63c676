"""A log's samples as the payloads of the link's own frames, so that a page takes them as it takes a board's."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from greywhale.base.errors import UserError
from greywhale.dashboard.limits import SAMPLES
from greywhale.files.log import read_log
from greywhale.files.log.layout import QUANTITIES
from greywhale.protocol import schema
from greywhale.protocol.firmware import JOINTS, TICK_S

# A row of a recording has some 100 bytes. What is larger is not even read.
MOST_LOG_BYTES = 200 * SAMPLES.history
_COUNTS = np.dtype("<i2"), JOINTS
_PAYLOAD = np.dtype(
    [
        ("tick", "<u4"), ("state", "u1"), ("fault", "u1"),
        ("leader", *_COUNTS), ("follower", *_COUNTS), ("voltage", *_COUNTS),
    ]
)  # fmt: skip


def samples_of_log(path: Path) -> bytes:
    """The log's samples one after the other, `schema.Sample.SIZE` bytes each, in a board's counts.

    Ticks count from the log's first row. Of several rows within a tick the last stands, and a log holds no faults.
    """
    if path.is_file() and path.stat().st_size > MOST_LOG_BYTES:
        raise _too_long(path)
    log = read_log(path)
    ticks = np.rint((log.time - log.time[0]) / TICK_S)
    last = np.flatnonzero(np.diff(ticks, append=np.inf))
    if last.size > SAMPLES.history or ticks[-1] > np.iinfo(np.uint32).max:
        raise _too_long(path)
    rows = np.zeros(last.size, _PAYLOAD)
    rows["tick"] = ticks[last]
    rows["state"] = log.places[last]
    for name in QUANTITIES:
        rows[name] = np.clip(np.rint(log.held(name)[last] / schema.Sample.LSB[name]), -0x8000, 0x7FFF)
    return rows.tobytes()


def _too_long(path: Path) -> UserError:
    return UserError(
        f"{path}: it is longer than the {SAMPLES.history} samples that a page shows; measure it with "
        "`greywhale evaluate`."
    )
