"""A short log of an arm that follows, for verbs that read one."""

from __future__ import annotations

from pathlib import Path

from greywhale.files.log import LogWriter
from greywhale.files.log.layout import Origin
from greywhale.protocol.table import ParameterTable


def write_log(path: Path, seconds: float = 1.0, table: ParameterTable | None = None) -> None:
    crc = 1 if table is None else table.crc
    with LogWriter(path, Origin("0.1.0", "mega2560", crc, 1, 1, table)) as log:
        for row in range(int(seconds * 1000)):
            log.append(row / 1000, [0.1] * 4, [0.0] * 4, [row % 1000 / 1000] * 4, "following")
