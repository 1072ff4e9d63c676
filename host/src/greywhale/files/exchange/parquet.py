"""A log as Parquet: a column for each joint of each quantity, with its unit, and the header's facts beside them."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import IO

import numpy as np

from greywhale.base.formats.whole import write_whole
from greywhale.files.exchange.formats import import_extra
from greywhale.files.exchange.recording import ExportOptions, Recording
from greywhale.files.log.layout import STATES


def write(recordings: Iterable[Recording], out: Path, options: ExportOptions) -> list[Path]:
    """Write one recording with the log's own names of columns."""
    (one,) = recordings
    arrow = import_extra("--to parquet", "parquet", "pyarrow")
    parquet = import_extra("--to parquet", "parquet", "pyarrow.parquet")
    words = arrow.array(STATES)
    named = [("time_s", "s"), *((column.name, column.unit) for column in one.columns)]
    fields = [arrow.field(name, arrow.float64(), False, {"unit": unit}) for name, unit in named]
    fields.append(arrow.field("state", arrow.dictionary(arrow.int8(), arrow.string()), False))
    schema = arrow.schema(fields, one.log.facts)

    def fill(file: IO[bytes]) -> None:
        with parquet.ParquetWriter(file, schema, use_dictionary=["state"]) as writer:
            for rows in one.chunks():
                numbers = [one.log.time[rows], *(np.ascontiguousarray(column[rows]) for column in one.columns)]
                states = arrow.DictionaryArray.from_arrays(arrow.array(one.log.places[rows]), words)
                writer.write_batch(arrow.record_batch([*map(arrow.array, numbers), states], schema))

    write_whole(out, fill)
    return [out]
