"""Writes Intel HEX files for tests."""

from __future__ import annotations

import struct
from pathlib import Path

from greywhale.protocol import schema

SOURCES = "0123456789abcdef"  # the digest in the records below


def record(kind: int, address: int, data: bytes) -> str:
    body = bytes([len(data), *address.to_bytes(2, "big"), kind]) + data
    return f":{body.hex().upper()}{-sum(body) & 255:02X}\n"


def hex_text(data: bytes, start: int = 0) -> str:
    """The bytes from an address on, as avr-objcopy writes them: a linear address record for each 64 KB."""
    lines = []
    for offset in range(0, len(data), 16):
        address = start + offset
        if offset == 0 or address % 65536 < 16:
            lines.append(record(4, 0, (address >> 16).to_bytes(2, "big")))
        lines.append(record(0, address & 0xFFFF, data[offset : offset + 16]))
    return "".join(lines) + record(1, 0, b"")


def image_record(signature: bytes, layout: int = 1) -> bytes:
    """The record that firmware/src/image_record.cpp puts into each image."""
    fields = (b"greywhale image\0", layout, signature, 3, 2, 1, schema.SCHEMA_HASH, SOURCES.encode() + b"\0")
    return struct.pack("<16sB3s3BI17s", *fields)


def write_image(path: Path, signature: bytes | None = None, size: int = 600) -> Path:
    """An image of random-looking bytes, with a record where a signature is given."""
    content = bytearray(i * 7 & 255 for i in range(size))
    if signature is not None:
        found = image_record(signature)
        content[301 : 301 + len(found)] = found  # lies across the lines of the file
    path.write_text(hex_text(bytes(content)))
    return path
