"""STK500, the two languages of Arduinos' bootloaders.

Addresses are in bytes and even. A wrong answer, or none in time, is None, False or empty.
"""

from __future__ import annotations

from functools import reduce
from operator import xor
from typing import Protocol

from greywhale.board.flash.talk import Talk


class Stk500(Protocol):
    """The requests that a bootloader answers."""

    erases_in_order: bool  # one page after the other from the first on, whichever page is written

    def __init__(self, talk: Talk) -> None: ...

    def enter(self, lost: bool = False) -> bool:
        """Ask until it answers, after a restart or after bytes were `lost`; whether it did."""

    def signature(self) -> bytes | None:
        """The chip's."""

    def write(self, address: int, page: bytes) -> bool:
        """Erase a page and write it."""

    def read(self, address: int, count: int) -> bytes | None: ...

    def leave(self) -> None:
        """Let it start the firmware."""


class Version1:
    """The Nano's: a command of one letter and a space; "in sync", the answer, "ok"."""

    erases_in_order = False
    _IN_SYNC, _OK = b"\x14", b"\x10"

    def __init__(self, talk: Talk) -> None:
        self._talk = talk

    def enter(self, lost: bool = False) -> bool:
        return self._talk.hear(b"0 ", self._IN_SYNC + self._OK, lost)

    def signature(self) -> bytes | None:
        return self._ask(b"u", 3)

    def write(self, address: int, page: bytes) -> bool:
        return self._seek(address) and self._ask(b"d" + len(page).to_bytes(2, "big") + b"F" + page) is not None

    def read(self, address: int, count: int) -> bytes | None:
        return self._ask(b"t" + count.to_bytes(2, "big") + b"F", count) if self._seek(address) else None

    def leave(self) -> None:
        self._ask(b"Q")

    def _seek(self, address: int) -> bool:
        return self._ask(b"U" + (address // 2).to_bytes(2, "little")) is not None

    def _ask(self, command: bytes, count: int = 0) -> bytes | None:
        self._talk.write(command + b" ")
        answer = self._talk.read(count + 2)
        return answer[1:-1] if answer[:1] == self._IN_SYNC and answer[count + 1 :] == self._OK else None


class Version2:
    """The Mega's: messages with start, sequence number, length, token, body and checksum."""

    erases_in_order = True
    _SIGN_ON, _LOAD_ADDRESS, _LEAVE = b"\x01", b"\x06", b"\x11\x01\x01"
    _PROGRAM, _READ, _SPI = b"\x13", b"\x14", b"\x1d"
    # How to write a page and to wait, for a programmer; a bootloader knows that by itself.
    _HOW_TO_WRITE, _HOW_TO_READ = b"\xc1\x0a\x40\x4c\x20\x00\x00", b"\x20"
    _BEYOND_64_KB = 1 << 31

    def __init__(self, talk: Talk) -> None:
        self._talk = talk
        self._sequence = 1  # with 1 every bootloader takes a message, older ones else only with the next number
        self._at: int | None = None  # where it goes on by itself

    def enter(self, lost: bool = False) -> bool:
        self._sequence, self._at = 1, None
        return self._talk.hear(self._message(self._SIGN_ON), b"\x0e\x01\x00\x08AVRISP_2", lost)

    def signature(self) -> bytes | None:
        """Byte by byte, as SPI commands that the bootloader answers itself."""
        answers = [self._ask(self._SPI + bytes([4, 4, 0, 0x30, 0, index, 0]), 5) for index in range(3)]
        return None if None in answers else b"".join(answer[3:4] for answer in answers if answer is not None)

    def write(self, address: int, page: bytes) -> bool:
        command = self._PROGRAM + len(page).to_bytes(2, "big") + self._HOW_TO_WRITE + page
        return self._go_on(address, command, len(page), 0) is not None

    def read(self, address: int, count: int) -> bytes | None:
        command = self._READ + count.to_bytes(2, "big") + self._HOW_TO_READ
        answer = self._go_on(address, command, count, count + 1)
        return answer[:-1] if answer is not None and answer[-1:] == b"\x00" else None

    def leave(self) -> None:
        self._ask(self._LEAVE, 0)

    def _go_on(self, address: int, command: bytes, moved: int, count: int) -> bytes | None:
        """The answer to a command that works on memory from an address on."""
        word = address // 2 | self._BEYOND_64_KB
        there = self._at == address or self._ask(self._LOAD_ADDRESS + word.to_bytes(4, "big"), 0) is not None
        answer = self._ask(command, count) if there else None
        self._at = None if answer is None else address + moved
        return answer

    def _message(self, body: bytes) -> bytes:
        message = bytes([0x1B, self._sequence]) + len(body).to_bytes(2, "big") + b"\x0e" + body
        return message + bytes([reduce(xor, message)])

    def _ask(self, body: bytes, count: int) -> bytes | None:
        """So many bytes as follow the command and "done" in the answer."""
        self._sequence = (self._sequence + 1) % 256
        self._talk.write(self._message(body))
        head = bytes([0x1B, self._sequence]) + (count + 2).to_bytes(2, "big") + b"\x0e" + body[:1] + b"\x00"
        answer = self._talk.read(len(head) + count + 1)
        sound = answer.startswith(head) and len(answer) == len(head) + count + 1 and reduce(xor, answer) == 0
        return answer[len(head) : -1] if sound else None


LANGUAGES: dict[int, type[Stk500]] = {1: Version1, 2: Version2}  # by version
