"""Firmware images (Intel HEX): those that come with greywhale, and what an image says about itself.

Every image of greywhale holds a record that firmware/src/image_record.cpp wrote; images of others do not.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from greywhale.base import sentences
from greywhale.base.errors import BadUsage, os_reason
from greywhale.board.flash import rules
from greywhale.board.flash.targets import FlashBoard

PACKAGED = Path(__file__).resolve().parents[2] / "data" / "firmware"

_RECORD = struct.Struct("<16sB3s3BI17s")
assert _RECORD.size == rules.IMAGE_RECORD_BYTES
ERASED = bytes([rules.ERASED])

_FORM = re.compile("(?i):([0-9a-f]{2}){5,}")


@dataclass(frozen=True)
class Record:
    """For which chip the image is, its firmware's version and schema, and the digest of its sources."""

    signature: bytes
    version: str
    schema_hash: int
    sources: str


@dataclass(frozen=True)
class Image:
    """A HEX file: one past its last address, and its record, None where it has none."""

    path: Path
    end: int
    record: Record | None
    memory: bytes = field(repr=False)  # from address 0 to `end`; what the file leaves out is erased memory

    def content(self, block: range) -> bytes:
        return self.memory[block.start : block.stop]


def packaged_image(board: str) -> Path | None:
    """The image that came with this installation; a checkout has none, it builds its own."""
    path = PACKAGED / f"{board}.hex"
    return path if path.is_file() else None


def read_image(path: Path) -> Image:
    memory = bytearray()
    for address, data in read_pieces(path):
        end = address + len(data)
        memory.extend(ERASED * (end - len(memory)))
        memory[address:end] = data
    return Image(path, len(memory), _find_record(memory), bytes(memory))


def read_pieces(path: Path) -> list[tuple[int, bytes]]:
    """The contents of a HEX file: address and bytes of each stretch without a gap."""
    if not path.is_file():
        raise BadUsage(f"{path}: there is no such file; build one with `pio run`, or leave --hex out.")
    try:
        lines = re.split(r"\r\n?|\n", path.read_bytes().decode("ascii", "replace"))
    except OSError as error:
        raise BadUsage(f"{path}: cannot be read: {os_reason(error)}.") from None
    pieces: list[tuple[int, bytearray]] = []
    for address, data in _records(path, lines):
        if address + len(data) > rules.LARGEST_IMAGE_BYTES:
            raise BadUsage(f"{path}: {sentences.BEYOND_ANY_BOARD.format(address=hex(address))}")
        if pieces and address == pieces[-1][0] + len(pieces[-1][1]):
            pieces[-1][1].extend(data)
        elif data:
            pieces.append((address, bytearray(data)))
    if not pieces:
        raise BadUsage(f"{path}: {sentences.NO_DATA}")
    return [(address, bytes(data)) for address, data in pieces]


def check_image(image: Image, board: FlashBoard, port: str) -> None:
    """Refuse an image that is plainly for another board."""
    if image.record is not None and image.record.signature != board.signature:
        others = [other.title for other in rules.BOARDS.values() if other.signature == image.record.signature]
        meant = f"an {others[0]}" if others else f"a chip with signature {image.record.signature.hex()}"
        raise BadUsage(f"{image.path}: {sentences.OTHER_BOARD.format(meant=meant, port=port, board=board.title)}")
    if image.end > board.space:
        words = sentences.NO_ROOM.format(end=image.end, board=board.title, space=board.space)
        raise BadUsage(f"{image.path}: {words}")


def _records(path: Path, lines: list[str]) -> Iterator[tuple[int, bytes]]:
    """Address and bytes of each data record, until the record that ends the file."""
    base = 0
    for number, line in enumerate(lines, start=1):
        if not (text := line.strip(" \t")):
            continue
        kind, address, data = _parse(text, f"{path}, line {number}")
        if kind == rules.HEX_DATA:
            yield base + address, data
        elif kind == rules.HEX_END:
            return
        elif kind in (rules.HEX_SEGMENT, rules.HEX_LINEAR):
            base = int.from_bytes(data, "big") << (4 if kind == rules.HEX_SEGMENT else 16)
    raise BadUsage(f"{path}: {sentences.ENDS_TOO_EARLY}")


def _parse(line: str, where: str) -> tuple[int, int, bytes]:
    """Type, address and data of one record; one that moves the base has two bytes that say where to."""
    content = bytes.fromhex(line[1:]) if _FORM.fullmatch(line) else b"\xff"
    moves = len(content) > 3 and content[3] in (rules.HEX_SEGMENT, rules.HEX_LINEAR)
    if len(content) != content[0] + 5 or sum(content) % 256 or (moves and content[0] != 2):
        raise BadUsage(f"{where}: {sentences.NO_HEX_RECORD}")
    return content[3], int.from_bytes(content[1:3], "big"), content[4:-1]


def _find_record(memory: bytearray) -> Record | None:
    start = memory.find(rules.IMAGE_MAGIC)
    if start < 0 or start + _RECORD.size > len(memory):
        return None
    _, layout, signature, *version, schema_hash, sources = _RECORD.unpack_from(memory, start)
    if layout != rules.IMAGE_LAYOUT:
        return None
    return Record(signature, ".".join(map(str, version)), schema_hash, sources.rstrip(b"\0").decode("ascii", "replace"))
