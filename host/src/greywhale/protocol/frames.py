"""Frames on the wire: COBS( type | seq | payload | CRC-16 ) and a zero byte; docs/link.md has the definition.

Encoding is one call. Decoding takes bytes as they come, in pieces of any size, and finds its place again at the next
zero.
"""

from __future__ import annotations

from binascii import crc_hqx
from typing import NamedTuple

from cobs import cobs

from greywhale.base.errors import UserError

from .declared import CRC_START
from .schema import MAX_PAYLOAD

OVERHEAD = 4  # type, seq and CRC
MAX_WIRE = MAX_PAYLOAD + OVERHEAD + 1  # with the COBS byte, without the closing zero


class Frame(NamedTuple):
    type: int
    seq: int
    payload: bytes


def encode_frame(type: int, seq: int, payload: bytes) -> bytes:
    """The bytes of one frame, the closing zero included."""
    if len(payload) > MAX_PAYLOAD:
        raise UserError(
            f"A frame carries at most {MAX_PAYLOAD} bytes, but {len(payload)} were given; send less at once."
        )
    body = bytes((type, seq)) + payload
    encoded: bytes = cobs.encode(body + crc_hqx(body, CRC_START).to_bytes(2, "little"))
    return encoded + b"\0"


def decode_frame(wire: bytes) -> Frame | None:
    """The frame in the bytes between two zeros, or None when they are not one."""
    if not OVERHEAD < len(wire) <= MAX_WIRE:
        return None
    try:
        body = cobs.decode(wire)
    except cobs.DecodeError:
        return None
    if len(body) < OVERHEAD or crc_hqx(body[:-2], CRC_START) != body[-2] | body[-1] << 8:
        return None
    return Frame(body[0], body[1], body[2:-2])


class FrameDecoder:
    """Finds frames in a stream of bytes. `bad` counts the pieces between two zeros that were not a frame."""

    def __init__(self) -> None:
        self.bad = 0
        self._rest = b""
        self._skipping = False

    def feed(self, data: bytes) -> list[Frame]:
        """Take the next bytes and return the frames that they complete."""
        return [frame for frame, _ in self.feed_wire(data)]

    def feed_wire(self, data: bytes) -> list[tuple[Frame, bytes]]:
        """Feed bytes; return each whole frame with the bytes it came as, the closing zero included."""
        *whole, rest = (self._rest + data).split(b"\0")
        frames: list[tuple[Frame, bytes]] = []
        for wire in whole:
            if self._skipping:  # the tail of an overlong piece that is counted already
                self._skipping = False
            elif wire:
                frame = decode_frame(wire)
                if frame is None:
                    self.bad += 1
                else:
                    frames.append((frame, wire + b"\0"))
        if len(rest) > MAX_WIRE and not self._skipping:
            self._skipping = True
            self.bad += 1
        self._rest = b"" if self._skipping else rest
        return frames

    def reset(self) -> None:
        """Forget a piece of a frame, as after the port was opened anew."""
        self._rest = b""
        self._skipping = False
