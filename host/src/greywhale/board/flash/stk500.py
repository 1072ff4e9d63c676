"""STK500, the two languages of Arduinos' bootloaders.

Addresses are in bytes and even. A wrong answer, or none in time, is None, False or empty.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import xor
from typing import Protocol

from greywhale.board.flash.question import ANY, Question, keep
from greywhale.board.flash.rules import Stk500V1, Stk500V2
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
    """The Nano's."""

    erases_in_order = False

    def __init__(self, talk: Talk) -> None:
        self._talk = talk

    def enter(self, lost: bool = False) -> bool:
        question = Stk500V1.enter()
        return self._talk.hear(bytes(question.asks), bytes(question.answer), lost)

    def signature(self) -> bytes | None:
        return self._ask(Stk500V1.signature())

    def write(self, address: int, page: bytes) -> bool:
        return self._seek(address) and self._ask(Stk500V1.write_page(page)) is not None

    def read(self, address: int, count: int) -> bytes | None:
        return self._ask(Stk500V1.read_page(count)) if self._seek(address) else None

    def leave(self) -> None:
        self._ask(Stk500V1.leave())

    def _seek(self, address: int) -> bool:
        return self._ask(Stk500V1.load_address(address // 2)) is not None

    def _ask(self, question: Question) -> bytes | None:
        self._talk.write(bytes(question.asks))
        return keep(self._talk.read(len(question.answer)), question.answer)


class Version2:
    """The Mega's."""

    erases_in_order = True

    def __init__(self, talk: Talk) -> None:
        self._talk = talk
        self._sequence = 1  # with 1 every bootloader takes a message, older ones else only with the next number
        self._at: int | None = None  # where it goes on by itself

    def enter(self, lost: bool = False) -> bool:
        self._sequence, self._at = 1, None
        question = Stk500V2.enter()
        return self._talk.hear(self._message(question.asks), bytes(question.answer), lost)

    def signature(self) -> bytes | None:
        answers = [self._ask(Stk500V2.signature(index)) for index in range(3)]
        return None if None in answers else b"".join(answer for answer in answers if answer is not None)

    def write(self, address: int, page: bytes) -> bool:
        return self._go_on(address, Stk500V2.write_page(page), len(page)) is not None

    def read(self, address: int, count: int) -> bytes | None:
        return self._go_on(address, Stk500V2.read_page(count), count)

    def leave(self) -> None:
        self._ask(Stk500V2.leave())

    def _go_on(self, address: int, question: Question, moved: int) -> bytes | None:
        """The answer to a question about memory from an address on."""
        there = self._at == address or self._ask(Stk500V2.load_address(address // 2)) is not None
        answer = self._ask(question) if there else None
        self._at = None if answer is None else address + moved
        return answer

    def _message(self, body: Sequence[int]) -> bytes:
        message = bytes(Stk500V2.message(self._sequence, body))
        return message + bytes([reduce(xor, message)])

    def _ask(self, question: Question) -> bytes | None:
        self._sequence = (self._sequence + 1) % 256
        self._talk.write(self._message(question.asks))
        pattern = [*Stk500V2.message(self._sequence, question.answer), ANY]
        heard = self._talk.read(len(pattern))
        return None if reduce(xor, heard, 0) else keep(heard, pattern)


LANGUAGES: dict[int, type[Stk500]] = {1: Version1, 2: Version2}  # by version
