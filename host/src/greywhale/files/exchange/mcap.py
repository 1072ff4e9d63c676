"""A log as MCAP for PlotJuggler, Foxglove and others: a protobuf message each sample, with a field of its own for
each joint, because viewers draw a field as a curve and an array as none.

The time of a message is the board's. Its schema lies in the file, and so do the header's facts, as metadata.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from greywhale.base.formats.whole import write_whole
from greywhale.base.types import Floats
from greywhale.files.exchange.formats import import_extra
from greywhale.files.exchange.recording import ExportOptions, Recording
from greywhale.files.log.layout import STATES

TOPIC, MESSAGE, ENUM = "/arm", "Sample", "State"
PACKAGE = "greywhale"
FACTS, UNITS = "greywhale log", "greywhale units"  # names of the metadata
# Protobuf writes the number of a field and how its value is encoded before each value.
_VARINT, _EIGHT_BYTES = 0, 1


def write(recordings: Iterable[Recording], out: Path, options: ExportOptions) -> list[Path]:
    """Write one recording; times are whole ns."""
    (one,) = recordings
    mcap = import_extra("--to mcap", "mcap", "mcap.writer")

    def fill(file: IO[bytes]) -> None:
        writer = mcap.Writer(file)
        writer.start(library=PACKAGE)
        schema = writer.register_schema(f"{PACKAGE}.{MESSAGE}", "protobuf", schema_of(one))
        channel = writer.register_channel(TOPIC, "protobuf", schema)
        for number, (time_ns, message) in enumerate(_messages(one)):
            writer.add_message(channel, time_ns, message, time_ns, number)
        writer.add_metadata(FACTS, one.log.facts)
        writer.add_metadata(UNITS, {column.name: column.unit for column in one.columns})
        writer.finish()

    write_whole(out, fill)
    return [out]


def schema_of(one: Recording) -> bytes:
    """The schema of a sample as a serialized FileDescriptorSet: the state, then a double for each column."""
    descriptors = import_extra("--to mcap", "mcap", "google.protobuf.descriptor_pb2")
    found = descriptors.FileDescriptorSet()
    file = found.file.add(name="greywhale.proto", package=PACKAGE, syntax="proto3")
    states = file.enum_type.add(name=ENUM)
    for place, word in enumerate(STATES):
        states.value.add(name=word.upper(), number=place)
    message = file.message_type.add(name=MESSAGE)
    kind = descriptors.FieldDescriptorProto
    common: dict[str, Any] = {"label": kind.LABEL_OPTIONAL}
    message.field.add(name="state", number=1, type=kind.TYPE_ENUM, type_name=f".{PACKAGE}.{ENUM}", **common)
    for number, column in enumerate(one.columns, 2):
        message.field.add(name=column.name, number=number, type=kind.TYPE_DOUBLE, **common)
    serialized: bytes = found.SerializeToString()
    return serialized


def _messages(one: Recording) -> Iterator[tuple[int, bytes]]:
    """The time of each sample in ns, and its message. All have one length, so numpy encodes many at once."""
    columns = one.columns
    tags = [_varint(1 << 3 | _VARINT), *(_varint(number << 3 | _EIGHT_BYTES) for number in range(2, len(columns) + 2))]
    values: list[tuple[str, str]] = [("state", "u1"), *((column.name, "<f8") for column in columns)]
    kinds = [
        pair for tag, value in zip(tags, values, strict=True) for pair in ((f"={value[0]}", f"V{len(tag)}"), value)
    ]
    form = np.dtype(kinds)
    for rows in one.chunks():
        states = one.log.places[rows]
        encoded = np.empty(len(states), form)
        for tag, (name, _) in zip(tags, values, strict=True):
            encoded[f"={name}"] = np.void(tag)
        encoded["state"] = states
        for column in columns:
            encoded[column.name] = column[rows]
        times = whole_us(one.log.time[rows]) * 1000
        yield from zip(times.tolist(), encoded.view(f"V{form.itemsize}").tolist(), strict=True)


def _varint(number: int) -> bytes:
    """A whole number as protobuf writes it: seven bits a byte, the lowest first."""
    bits = []
    while number > 0x7F:
        bits.append(number & 0x7F | 0x80)
        number >>= 7
    return bytes([*bits, number])


def whole_us(time_s: Floats) -> NDArray[np.int64]:
    """Times of a log in us; it has no parts of them."""
    return np.round(time_s * 1e6).astype(np.int64)
