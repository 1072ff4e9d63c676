"""The two kinds of bootloader on lines in this process: each answers in its own way, at its own speed only.

The host's patience is counted by the line's own clock, which only reading moves.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable
from functools import partial, reduce
from operator import xor
from typing import Self

from greywhale.protocol.transport import LINES

MEGA2560 = b"\x1e\x98\x01"
ATMEGA328P = b"\x1e\x95\x0f"
TURN_S = 0.02
FLASH_BYTES = 1 << 18
# By the first byte of a question, in either language.
KINDS = dict.fromkeys(b"\x06U", "seek") | dict.fromkeys(b"\x14t", "read") | dict.fromkeys(b"\x13d", "write")
KINDS |= dict.fromkeys(b"\x11Q", "leave")
_numbers = itertools.count()
# What goes wrong with a question, by its kind and how many of that kind came before: "question" or "answer" gets lost,
# "garbled" is an answer with a wrong byte, "" nothing. It may also raise what the host then meets with.
Spoil = Callable[[str, int], str]


class FakeBootloader:
    """The other end of a line; `port` is what a host opens, `heard` is the speeds at which it was spoken to."""

    restarted = True
    page: int  # bytes

    def __init__(self, baud: int, signature: bytes, memory: bytes = b"", spoil: Spoil = lambda kind, count: "") -> None:
        """`memory` is the program memory from its beginning; the rest is erased."""
        self.memory = bytearray(memory.ljust(FLASH_BYTES, b"\xff"))
        self.spoil = spoil
        self.asked: Counter[str] = Counter()  # kinds of questions: seek, read, write, leave, other
        self.address = 0  # that was loaded last
        self.signature = signature
        self.port = f"bootloader {next(_numbers)}"
        self.heard: set[int] = set()
        self._speed = baud
        self._speed_of_host = 0
        self._buffer = self._said = b""
        self._now = 0.0

    @property
    def left(self) -> bool:
        """True once the host has sent it back to the firmware."""
        return self.asked["leave"] > 0

    def content(self, count: int) -> bytes:
        """So many bytes from the address on that was loaded last."""
        start = self.address
        self.address += count
        return bytes(self.memory[start : self.address])

    def program(self, erased: int, content: bytes) -> None:
        """Erase a page, then clear the bits of memory that are clear in what is written."""
        self.memory[erased : erased + self.page] = b"\xff" * self.page
        for byte in content:
            self.memory[self.address] &= byte
            self.address += 1

    def heed(self, kind: str, reply: Callable[[], bytes]) -> bytes:
        """The answer to a question, as it arrives."""
        wrong = self.spoil(kind, self.asked[kind])
        self.asked[kind] += 1
        if wrong == "question":
            return b""
        answer = reply()
        if wrong == "garbled":
            return answer[:-1] + bytes([answer[-1] ^ 0xFF])
        return b"" if wrong == "answer" else answer

    def answer(self, data: bytes) -> tuple[bytes, bytes]:
        """The answer to `data`, and the part of it that is kept until more comes."""
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

    page = 128

    def answer(self, data: bytes) -> tuple[bytes, bytes]:
        said = b""
        while len(data) >= 3 or (len(data) == 2 and data[:1] not in b"Utd"):
            more = int.from_bytes(data[1:3], "big") if data[:1] == b"d" else 0
            length = {b"U": 4, b"t": 5, b"d": 5 + more}.get(data[:1], 2)
            if len(data) < length:
                break
            command, data = data[:length], data[length:]
            said += self.heed(KINDS.get(command[0], "other"), partial(self._reply, command))
        return said, data

    def _reply(self, command: bytes) -> bytes:
        said = {b"u ": self.signature, b"0 ": b"", b"Q ": b""}.get(command)
        if command[:1] == b"U":
            self.address, said = 2 * int.from_bytes(command[1:3], "little"), b""
        elif command[:1] == b"t":
            said = self.content(int.from_bytes(command[1:3], "big"))
        elif command[:1] == b"d":
            assert command[3:4] + command[-1:] == b"F ", "flash, not EEPROM"
            self.program(self.address, command[4:-1])
            said = b""
        return b"" if said is None else b"\x14" + said + b"\x10"


class Version2(FakeBootloader):
    """The Mega's: framed messages; everything else is skipped. An older one, which counts them."""

    page = 256
    _erase_at = _next = 0

    def open(self, restart: bool, baud: int) -> Self:
        self._erase_at = self._next = 0
        return super().open(restart, baud)

    def answer(self, data: bytes) -> tuple[bytes, bytes]:
        said = b""
        while (start := data.find(b"\x1b")) >= 0:
            data = data[start:]
            end = 6 + int.from_bytes(data[2:4], "big")
            if len(data) < 4 or len(data) < end:
                return said, data
            message, data = data[:end], data[end:]
            assert reduce(xor, message) == 0
            said += self.heed(KINDS.get(message[5], "other"), partial(self._frame, message))
        return said, b""

    def _frame(self, message: bytes) -> bytes:
        sequence = message[1]
        if sequence not in (1, self._next):
            return b""
        self._next = (sequence + 1) % 256
        answer = self._reply(message[5:-1])
        framed = bytes([0x1B, sequence]) + len(answer).to_bytes(2, "big") + b"\x0e" + answer
        return framed + bytes([reduce(xor, framed)])

    def _reply(self, body: bytes) -> bytes:
        if body == b"\x01":
            return b"\x01\x00\x08AVRISP_2"
        if body[:1] == b"\x06":
            self.address = 2 * int.from_bytes(body[1:5], "big") % (1 << 32)
        elif body[:1] == b"\x14":
            return b"\x14\x00" + self.content(int.from_bytes(body[1:3], "big")) + b"\x00"
        elif body[:1] == b"\x13":
            assert len(body) == 10 + int.from_bytes(body[1:3], "big")
            self.program(self._erase_at, body[10:])
            self._erase_at += self.page
        elif body[:1] == b"\x1d":
            assert body[:6] == b"\x1d\x04\x04\x00\x30\x00", "only the signature is read"
            return bytes([0x1D, 0, 0, 0x30, 0, self.signature[body[6]], 0])
        return body[:1] + b"\x00"
