"""Asks the bootloader on a port who it is: the Mega's and the Nano's speak differently, and each tells its chip.

Nothing is written.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass

from greywhale.base import sentences
from greywhale.base.errors import UserError
from greywhale.board.flash.rules import ROUNDS, START_S
from greywhale.board.flash.stk500 import LANGUAGES, Stk500
from greywhale.board.flash.talk import Talk
from greywhale.protocol.lines import open_line


@dataclass(frozen=True)
class Dialect:
    """The version of STK500, and the speed."""

    version: int
    baud: int


@dataclass(frozen=True)
class Bootloader:
    """The dialect that a bootloader answers in, and the signature of its chip, None where it did not tell that."""

    dialect: Dialect
    signature: bytes | None


def find_bootloader(port: str, likely: Sequence[Dialect], others: Sequence[Dialect]) -> Bootloader:
    """The bootloader that answers; the likely ones are tried again and again, the others once after them.

    Every try opens the port anew, which resets the board and so starts its bootloader.
    """
    for dialect in [*list(likely) * ROUNDS, *others]:
        with _open(port, dialect) as line:
            if line.enter():
                return Bootloader(dialect, line.signature())
    tried = " and ".join(dict.fromkeys(str(dialect.baud) for dialect in likely))
    raise UserError(f"{port}: {sentences.NO_BOOTLOADER.format(bauds=tried)}")


@contextmanager
def enter_bootloader(port: str, dialect: Dialect) -> Iterator[Stk500]:
    """A bootloader that was found before; opening the port restarts the board."""
    with _open(port, dialect) as line:
        if not line.enter():
            raise UserError(f"{port}: the bootloader answered once, but not again; try again.")
        yield line


@contextmanager
def _open(port: str, dialect: Dialect) -> Iterator[Stk500]:
    with closing(open_line(port, baud=dialect.baud)) as line:
        line.wait(START_S)
        yield LANGUAGES[dialect.version](Talk(line))
