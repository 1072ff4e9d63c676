"""Parameter files as an older greywhale wrote them."""

from __future__ import annotations

from pathlib import Path

from greywhale.files import parameter_file
from greywhale.protocol import schema
from greywhale.protocol.table import ParameterTable


def write_older(path: Path, table: ParameterTable, layout: int) -> None:
    """A table without what newer layouts than this brought."""
    parameter_file.save(path, table)
    newer = tuple(one.name.rpartition(".")[2] for one in schema.PARAMETERS if one.since > layout)
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join(line for line in lines if not line.startswith(newer)))
