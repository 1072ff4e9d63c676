"""A log as numpy's .npz: an array for each quantity, the header's facts and the units as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.base.formats.whole import write_whole
from greywhale.files.exchange.recording import ExportOptions, Recording
from greywhale.files.log.layout import STATES


def write(recordings: Iterable[Recording], out: Path, options: ExportOptions) -> list[Path]:
    """Write one recording: `time_s` (rows,), each quantity (rows, joints), `state` (rows,) as places in `states`."""
    (one,) = recordings
    arrays: dict[str, Any] = {
        "time_s": one.log.time,
        # numpy makes an array of each when it writes it, so of a long log one stands in memory.
        **{quantity.name: quantity.values for quantity in one.quantities},
        "state": one.log.places,
        "states": np.array(STATES),
        "units": np.array(json.dumps(one.units)),
        "facts": np.array(json.dumps(one.log.facts)),
    }
    write_whole(out, lambda file: np.savez(file, **arrays))
    return [out]
