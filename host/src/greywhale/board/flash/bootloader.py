"""Asks the bootloader on a port who it is: the Mega's and the Nano's speak differently, and each tells its chip.

Nothing is written. Asked directly it takes a second; avrdude itself needs a minute to give up at the wrong speed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import reduce
from operator import xor

from greywhale.base.errors import UserError
from greywhale.protocol.transport import Line, open_line

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


class Talk:
    """A line to a bootloader, an answer at a time."""

    def __init__(self, line: Line) -> None:
        self.write = line.write
        self._line = line
        self._heard = b""

    def read(self, count: int, wait_s: float = _TRY_S) -> bytes:
        """So many bytes, or fewer where no more came in time."""
        self._wait(lambda: len(self._heard) >= count, wait_s)
        taken, self._heard = self._heard[:count], self._heard[count:]
        return taken

    def hear(self, question: bytes, answer: bytes) -> bool:
        """Ask again and again until the answer comes, or no more."""
        end = self._line.clock() + _TRY_S
        while answer not in self._heard and self._line.clock() < end:
            self.write(question)
            self._wait(lambda: answer in self._heard, _ASK_EVERY_S)
        return answer in self._heard

    def forget(self) -> None:
        """Let pass what still comes, such as answers to questions that were asked twice."""
        while self.read(64, _ASK_EVERY_S):
            pass

    def _wait(self, done: Callable[[], bool], wait_s: float) -> None:
        end = self._line.clock() + wait_s
        while not done() and self._line.clock() < end:
            self._heard += self._line.read()


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


@contextmanager
def enter_bootloader(port: str, dialect: Dialect) -> Iterator[Talk]:
    """The line to a bootloader that was found before; opening it restarts the board."""
    with _open(port, dialect) as line:
        if not _enter(line, dialect):
            raise UserError(f"{port}: the bootloader answered once, but not again; try again.")
        yield line


@contextmanager
def _open(port: str, dialect: Dialect) -> Iterator[Talk]:
    with closing(open_line(port, baud=dialect.baud)) as line:
        yield Talk(line)


def _enter(line: Talk, dialect: Dialect) -> bool:
    question, answer, _ = _DIALECTS[dialect.programmer]
    if not line.hear(question, answer):
        return False
    line.forget()
    return True


def _try(port: str, dialect: Dialect) -> Bootloader | None:
    *_, read_signature = _DIALECTS[dialect.programmer]
    with _open(port, dialect) as line:
        return Bootloader(dialect, read_signature(line)) if _enter(line, dialect) else None


# STK500 version 1, the Nano's: a command and a space; "in sync", the answer, "ok".
_IN_SYNC, _OK = b"\x14", b"\x10"


def _read_signature_1(line: Talk) -> bytes | None:
    line.write(b"u ")
    return version_1_answer(line, 3)


def version_1_answer(line: Talk, count: int) -> bytes | None:
    """The bytes of an answer of the Nano's bootloader; None where it is wrong."""
    answer = line.read(count + 2)
    return answer[1:-1] if answer[:1] == _IN_SYNC and answer[count + 1 :] == _OK else None


# STK500 version 2, the Mega's: messages with start, sequence number, length, token, body and checksum.
_SIGN_ON = b"\x01"


def _message(sequence: int, body: bytes) -> bytes:
    message = bytes([0x1B, sequence]) + len(body).to_bytes(2, "big") + b"\x0e" + body
    return message + bytes([reduce(xor, message)])


def _read_signature_2(line: Talk) -> bytes | None:
    """Byte by byte, as SPI commands that the bootloader answers itself."""
    signature = b""
    for index in range(3):
        answer = version_2_answer(line, bytes([0x1D, 4, 4, 0, 0x30, 0, index, 0]), 2 + index)
        if answer is None or len(answer) != 7 or answer[:2] != b"\x1d\x00":
            return None
        signature += answer[5:6]
    return signature


def version_2_answer(line: Talk, body: bytes, sequence: int = 1) -> bytes | None:
    """Send a message to the Mega's bootloader; the body of its answer, None where that is wrong."""
    line.write(_message(sequence, body))
    head = line.read(5)
    if len(head) < 5 or head[:2] != bytes([0x1B, sequence]) or head[4:] != b"\x0e":
        return None
    rest = line.read(int.from_bytes(head[2:4], "big") + 1)
    return rest[:-1] if len(rest) > 1 and reduce(xor, head + rest) == 0 else None


def read_version_2(line: Talk, word: int, count: int) -> bytes | None:
    """So many bytes of program memory from a word address on; None where the answer was wrong."""
    if version_2_answer(line, b"\x06" + word.to_bytes(4, "big")) != b"\x06\x00":
        return None
    answer = version_2_answer(line, b"\x14" + count.to_bytes(2, "big") + b"\x20")
    whole = answer is not None and len(answer) == count + 3 and answer[:2] == b"\x14\x00" and answer[-1] == 0
    return answer[2:-1] if answer is not None and whole else None


# Of each programmer: a question and the answer of whoever listens, and what reads the signature.
_DIALECTS = {
    "arduino": (b"0 ", _IN_SYNC + _OK, _read_signature_1),
    "wiring": (_message(1, _SIGN_ON), b"\x0e\x01\x00\x08AVRISP_2", _read_signature_2),
}
