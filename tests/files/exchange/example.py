"""A log with every state, all header facts and numbers of many digits, and the recording of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from greywhale.files.exchange.recording import JointColumns, Recording
from greywhale.files.log import LogWriter, read_log
from greywhale.files.log.layout import STATES, Origin
from greywhale.protocol.table import ParameterTable

ROWS = 500


def write_example(path: Path, rows: int = ROWS) -> Path:
    table = ParameterTable.defaults()
    numbers = np.random.default_rng(1).uniform(-2.4, 2.4, (rows, 12))
    with LogWriter(path, Origin("0.1.0", "mega2560", table.crc, 1, 1, table)) as log:
        for row, values in enumerate(numbers.tolist()):
            state = STATES[min(row // 10, 3)] if row < rows - 10 else "fault"
            log.append(12.5 + row / 1000, values[:4], values[4:8], values[8:], state)
        log.drop(3)
    return path


def example(path: Path) -> Recording:
    """With a further quantity."""
    log = read_log(write_example(path))
    return Recording(log, (JointColumns("external_torque", "N m", 0.25 * log.voltage),))
