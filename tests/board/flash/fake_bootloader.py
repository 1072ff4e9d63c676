"""The two kinds of bootloader on lines in this process: each answers in its own way, at its own speed only.

The host's patience is counted by the line's own clock, which only reading moves.
"""

from __future__ import annotations

import itertools
from functools import reduce
from operator import xor
from typing import Self

from greywhale.protocol.transport import LINES

MEGA2560 = b"\x1e\x98\x01"
ATMEGA328P = b"\x1e\x95\x0f"
TURN_S = 0.02
_numbers = itertools.count()


class FakeBootloader:
    """The other end of a line; `port` is what a host opens, `heard` is the speeds at which it was spoken to."""

    restarted = True

    def __init__(self, baud: int, signature: bytes, memory: bytes = b"", garble: int = 0) -> None:
        """`memory` is the program memory; of its first `garble` answers to a read the last byte is wrong."""
        self.memory, self.garble = memory, garble
        self.left = False  # whether the host has sent it back to the firmware
        self.word = 0  # the address that was loaded last
        self.signature = signature
        self.port = f"bootloader {next(_numbers)}"
        self.heard: set[int] = set()
        self._speed = baud
        self._speed_of_host = 0
        self._buffer = self._said = b""
        self._now = 0.0

    def content(self, count: int) -> bytes:
        """So many bytes from the address on that was loaded last."""
        start = 2 * self.word
        self.word += count // 2
        return self.memory[start : start + count].ljust(count, b"\xff")

    def garbled(self, answer: bytes) -> bytes:
        """An answer to a read, the first ones with a wrong byte."""
        if self.garble == 0:
            return answer
        self.garble -= 1
        return answer[:-1] + bytes([answer[-1] ^ 0xFF])

    def answer(self, data: bytes) -> tuple[bytes, bytes]:
        """What to say to `data`, and what of it is kept until more comes."""
        raise NotImplementedError

    def open(self, restart: bool, baud: int) -> Self:
        assert restart, "that is what starts a bootloader"
        self._speed_of_host = baud
        self._buffer = self._said = b""
        return self

    def write(self, data: bytes) -> None:
        self.heard.add(self._speed_of_host)
        if self._speed_of_host == self._speed:  # at another speed it hears noise
            said, self._buffer = self.answer(self._buffer + data)
            self._said += said

    def read(self) -> bytes:
        if not self._said:
            self.wait(TURN_S)
            self._buffer = b""  # half a question, or what another bootloader was asked
        taken, self._said = self._said, b""
        return taken

    def clock(self) -> float:
        return self._now

    def wait(self, seconds: float) -> None:
        self._now += seconds

    def close(self) -> None:
        """Nothing is open."""

    def __enter__(self) -> Self:
        LINES[self.port] = self.open
        return self

    def __exit__(self, *_: object) -> None:
        del LINES[self.port]


class Version1(FakeBootloader):
    """The Nano's: commands of one letter and a space."""

    def answer(self, data: bytes) -> tuple[bytes, bytes]:
        said = b""
        while len(data) >= 2:
            length = {b"U": 4, b"t": 5}.get(data[:1], 2)
            if len(data) < length:
                break
            command, data = data[:length], data[length:]
            said += self._say(command)
        return said, data

    def _say(self, command: bytes) -> bytes:
        if command[:1] == b"U":
            self.word = int.from_bytes(command[1:3], "little")
            return b"\x14\x10"
        if command[:1] == b"t":
            return self.garbled(b"\x14" + self.content(int.from_bytes(command[1:3], "big")) + b"\x10")
        self.left = self.left or command == b"Q "
        known = {b"0 ": b"\x14\x10", b"u ": b"\x14" + self.signature + b"\x10", b"Q ": b"\x14\x10"}
        return known.get(command, b"")


class Version2(FakeBootloader):
    """The Mega's: framed messages; everything else is skipped."""

    def answer(self, data: bytes) -> tuple[bytes, bytes]:
        said = b""
        while (start := data.find(b"\x1b")) >= 0:
            data = data[start:]
            end = 6 + int.from_bytes(data[2:4], "big")
            if len(data) < 4 or len(data) < end:
                return said, data
            message, data = data[:end], data[end:]
            assert reduce(xor, message) == 0
            said += self._reply(message[1], message[5:-1])
        return said, b""

    def _reply(self, sequence: int, body: bytes) -> bytes:
        if body == b"\x01":
            answer = b"\x01\x00\x08AVRISP_2"
        elif body[:1] == b"\x06":
            self.word = int.from_bytes(body[1:5], "big")
            answer = b"\x06\x00"
        elif body[:1] == b"\x14":
            answer = b"\x14\x00" + self.content(int.from_bytes(body[1:3], "big")) + b"\x00"
        elif body[:1] == b"\x11":
            self.left, answer = True, b"\x11\x00"
        else:
            assert body[:6] == b"\x1d\x04\x04\x00\x30\x00", "only the signature is read"
            answer = bytes([0x1D, 0, 0, 0x30, 0, self.signature[body[6]], 0])
        message = bytes([0x1B, sequence]) + len(answer).to_bytes(2, "big") + b"\x0e" + answer
        whole = message + bytes([reduce(xor, message)])
        return self.garbled(whole) if body[:1] == b"\x14" else whole
