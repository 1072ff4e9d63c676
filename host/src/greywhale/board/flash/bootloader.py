"""Asks the bootloader on a port who it is: the Mega's and the Nano's speak differently, and each tells its chip.

Nothing is written. Asked directly it takes a second; avrdude itself needs a minute to give up at the wrong speed.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from operator import xor

import serial

from greywhale.errors import UserError
from greywhale.protocol.transport import open_serial

_ASK_EVERY_S = 0.05
# A bootloader that listens answers the first question; all kinds listen for at least half a second after the reset.
_TRY_S = 0.5
_ROUNDS = 3


@dataclass(frozen=True)
class Dialect:
    """What avrdude calls the programmer, and the speed."""

    programmer: str
    baud: int


@dataclass(frozen=True)
class Bootloader:
    """Who answered in which dialect, and the signature of its chip, None where it did not tell that."""

    dialect: Dialect
    signature: bytes | None


def find_bootloader(port: str, likely: Sequence[Dialect], others: Sequence[Dialect]) -> Bootloader:
    """The bootloader that answers; the likely ones are tried again and again, the others once after them.

    Every try opens the port anew, which resets the board and so starts its bootloader.
    """
    for dialect in [*list(likely) * _ROUNDS, *others]:
        found = _try(port, dialect)
        if found is not None:
            return found
    tried = " and ".join(dict.fromkeys(str(dialect.baud) for dialect in likely))
    raise UserError(
        f"{port}: no bootloader answers at {tried} baud; check that the board's reset works, "
        "or burn a bootloader with a programmer."
    )


def _try(port: str, dialect: Dialect) -> Bootloader | None:
    ask, read_signature = _DIALECTS[dialect.programmer]
    with open_serial(port, dialect.baud, _ASK_EVERY_S) as line:
        try:
            if not ask(line):
                return None
            while line.read(64):  # answers to questions that were asked twice
                pass
            return Bootloader(dialect, read_signature(line))
        except (OSError, serial.SerialException):
            raise UserError(f"{port}: the port went away in the middle; check the cable and try again.") from None


def _hear(line: serial.Serial, question: bytes, answer: bytes) -> bool:
    """Ask again and again until the answer comes, or no more."""
    heard = b""
    end = time.monotonic() + _TRY_S
    while time.monotonic() < end:
        line.write(question)
        heard += line.read(64)
        if answer in heard:
            return True
    return False


# STK500 version 1, the Nano's: a command and a space; "in sync", the answer, "ok".
_IN_SYNC, _OK = b"\x14", b"\x10"


def _ask_version_1(line: serial.Serial) -> bool:
    return _hear(line, b"0 ", _IN_SYNC + _OK)


def _read_signature_1(line: serial.Serial) -> bytes | None:
    line.write(b"u ")
    answer = _read_exactly(line, 5)
    return answer[1:4] if answer[:1] == _IN_SYNC and answer[4:] == _OK else None


# STK500 version 2, the Mega's: messages with start, sequence number, length, token, body and checksum.
_SIGN_ON = b"\x01"


def _message(sequence: int, body: bytes) -> bytes:
    message = bytes([0x1B, sequence]) + len(body).to_bytes(2, "big") + b"\x0e" + body
    return message + bytes([reduce(xor, message)])


def _ask_version_2(line: serial.Serial) -> bool:
    return _hear(line, _message(1, _SIGN_ON), b"\x0e\x01\x00\x08AVRISP_2")


def _read_signature_2(line: serial.Serial) -> bytes | None:
    """Byte by byte, as SPI commands that the bootloader answers itself."""
    signature = b""
    for index in range(3):
        line.write(_message(2 + index, bytes([0x1D, 4, 4, 0, 0x30, 0, index, 0])))
        answer = _read_exactly(line, 13)
        if answer[:7] != bytes([0x1B, 2 + index, 0, 7, 0x0E, 0x1D, 0]) or reduce(xor, answer) != 0:
            return None
        signature += answer[10:11]
    return signature


def _read_exactly(line: serial.Serial, count: int) -> bytes:
    heard = b""
    end = time.monotonic() + _TRY_S
    while len(heard) < count and time.monotonic() < end:
        heard += line.read(count - len(heard))
    return heard


_DIALECTS = {"arduino": (_ask_version_1, _read_signature_1), "wiring": (_ask_version_2, _read_signature_2)}
