"""The serial line between board and host: a wrong baud rate garbles bytes, noise damages or loses them.

Baud rates that differ by a few percent work, as on a real line; beyond that the receiver samples the wrong
bits.
"""

from __future__ import annotations

import math
import random

from greywhale.base.errors import UserError

SAME_RATE_SHARE = 0.02  # closer rates cannot miss a bit: skip the bit model
ANY_BAUD = math.inf  # of a line without a speed: as its other end has it


def resample(data: bytes, sender_baud: float, receiver_baud: float) -> bytes:
    """The bytes that a receiver at another baud rate makes of `data` sent without gaps (8N1, each bit sampled in its
    middle).
    """
    if sender_baud <= 0.0 or receiver_baud <= 0.0:
        return b""
    if ANY_BAUD in (sender_baud, receiver_baud):
        return data
    ratio = sender_baud / receiver_baud  # sent bits in one of the receiver's
    if abs(ratio - 1.0) <= SAME_RATE_SHARE:
        return data
    levels = [bit for byte in data for bit in (0, *((byte >> shift) & 1 for shift in range(8)), 1)]
    received = bytearray()
    position = 0.0
    while True:
        start = int(position)
        while start < len(levels) and levels[start]:  # idle or stop level: wait for a start bit
            start += 1
        if start >= len(levels):
            return bytes(received)
        begin = max(position, float(start))
        byte = 0
        for bit in range(8):
            at = int(begin + (1.5 + bit) * ratio)
            byte |= (levels[at] if at < len(levels) else 1) << bit
        received.append(byte)
        position = begin + 9.5 * ratio  # the receiver looks for the next start from half a bit into the stop bit on


class Noise:
    """Damages or loses bytes at random, seeded, in both directions alike."""

    def __init__(self, seed: int = 1) -> None:
        self._random = random.Random(seed)
        self.flip = 0.0
        self.lose = 0.0

    def set(self, what: str, probability: float) -> None:
        """`what` is "flip" (one bit of the byte) or "lose" (the byte), `probability` per byte."""
        if what not in ("flip", "lose") or not 0.0 <= probability <= 1.0:
            raise UserError(f"line {what} {probability:g}: say flip or lose, and a probability in [0, 1].", 2)
        setattr(self, what, probability)

    def __call__(self, data: bytes) -> bytes:
        if not data or not (self.flip or self.lose):
            return data
        chance = self._random.random
        kept = bytearray(byte for byte in data if chance() >= self.lose)
        for index in range(len(kept)):
            if chance() < self.flip:
                kept[index] ^= 1 << self._random.randrange(8)
        return bytes(kept)
