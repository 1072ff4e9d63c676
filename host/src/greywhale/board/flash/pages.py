"""Writes an image into a board's program memory through its bootloader, and reads the memory back.

The Mega's bootloader erases one page after the other from the first on, whichever page is written. So a page behind a
gap of the image would be written over what an old program left there, or be erased after it was written.

Whatever ends the writing in the middle, the board does nothing: half of a new program with half of an old one could
do anything with the motors. So the first page, where a program starts, first gets an endless loop, and its content when
all else is there. The Mega's bootloader erases the first page again only after a restart.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack

from greywhale.base import sentences
from greywhale.base.errors import UserError
from greywhale.base.types import Progress
from greywhale.board.flash.bootloader import Dialect, enter_bootloader
from greywhale.board.flash.images import ERASED, Image
from greywhale.board.flash.rules import ATTEMPTS, LOOP
from greywhale.board.flash.stk500 import Stk500
from greywhale.protocol.transport import PortDisturbedError, PortLostError

_ERASED_WORD = 2 * ERASED  # a word that changes nothing wherever it is written, but a page is erased for it


class Memory:
    """The program memory behind a bootloader, which is asked again where a byte was lost on the way.

    The Nano's may end then. `restart` brings it back; without it that is told as silence.
    """

    def __init__(self, port: str, line: Stk500, restart: Callable[[], Stk500] | None = None) -> None:
        self.port, self.line, self._restart = port, line, restart

    def write(self, address: int, content: bytes) -> None:
        for _ in range(ATTEMPTS):
            if self.line.write(address, content):
                return
            self._resume("writing", address)
        raise self._silent("writing", address)

    def read(self, block: range) -> bytes:
        """A page at most."""
        for _ in range(ATTEMPTS):
            found = self.line.read(block.start, len(block) + len(block) % 2)  # whole words
            if found is not None:
                return found[: len(block)]
            self._resume("reading", block.start)
        raise self._silent("reading", block.start)

    def read_all(self, blocks: Sequence[range], what: str, report: Progress) -> Iterator[bytes]:
        for done, block in enumerate(blocks, start=1):
            yield self.read(block)
            report(what, done / len(blocks))

    def _resume(self, doing: str, address: int) -> None:
        if self.line.enter(lost=True) or self._restart is None:
            return
        try:
            self.line = self._restart()
        except PortLostError:
            raise
        except UserError:
            raise self._silent(doing, address) from None

    def _silent(self, doing: str, address: int) -> UserError:
        return UserError(f"{self.port}: {sentences.SILENT.format(doing=doing, address=hex(address))}")


def write_image(port: str, dialect: Dialect, image: Image, size: int, report: Progress) -> None:
    """Write the image in pages of this size, read all of it back, and let the board start it."""
    first, *others = blocks_of(image, size)
    loop = LOOP.ljust(size, ERASED)
    try:
        with ExitStack() as opened:

            def start() -> Stk500:
                opened.close()
                return opened.enter_context(enter_bootloader(port, dialect))

            line = start()
            # A restart lets the Mega's bootloader erase what is written already.
            memory = Memory(port, line, None if line.erases_in_order else start)
            held = [block for block in held_blocks(image, size) if block != first]
            pages = [first, *(others if _must_erase_gaps(memory, image, held, size) else held)]
            content = {page: image.content(page).ljust(size, ERASED) for page in held} | {first: loop}
            for done, page in enumerate(pages, start=1):
                memory.write(page.start, content.get(page, _ERASED_WORD))
                report("writing", done / len(pages))
            written = [first, *held]
            for page, found in zip(written, memory.read_all(written, "verifying", report), strict=True):
                _require(port, page, content[page][: len(page)], found)
        _write_first(port, dialect, first, image.content(first), size)
    except PortLostError:
        raise UserError(f"{port} went away while it was being flashed; connect the board and flash it again.") from None
    except (PortDisturbedError, KeyboardInterrupt) as ending:
        ending.add_note("The board was not flashed whole: flash it again.")
        raise


def _write_first(port: str, dialect: Dialect, page: range, content: bytes, size: int) -> None:
    """Write the first page, and let the board start. Once after each restart: a second write erases the next page."""
    found = b""
    for _ in range(ATTEMPTS):
        with enter_bootloader(port, dialect) as line:
            memory = Memory(port, line)
            memory.read(page)  # the first question may be lost, and asked again it does no harm
            line.write(page.start, content.ljust(size, ERASED))
            found = memory.read(page)
            if found == content:
                line.leave()
                return
    _require(port, page, content, found)


def blocks_of(image: Image, size: int) -> list[range]:
    return [range(start, min(start + size, image.end)) for start in range(0, image.end, size)]


def held_blocks(image: Image, size: int) -> list[range]:
    """The blocks that the image has something for; what it leaves out is never executed."""
    return [block for block in blocks_of(image, size) if image.content(block).strip(ERASED)]


def _must_erase_gaps(memory: Memory, image: Image, held: Sequence[range], size: int) -> bool:
    """True if a page behind a gap would not keep what is written there; `held` are those behind the first page."""
    late = [page for place, page in enumerate(held, start=1) if page.start != place * size]
    if not (memory.line.erases_in_order and late):
        return False
    if late[0].start <= len(held) * size:  # its turn to be erased comes after it was written
        return True
    return any(memory.read(page) not in (image.content(page), ERASED * len(page)) for page in late)


def _require(port: str, page: range, content: bytes, found: bytes) -> None:
    for at, wanted, holds in zip(page, content, found, strict=True):
        if wanted != holds:
            words = sentences.WRONG_BYTE.format(found=f"{holds:#04x}", address=hex(at), wanted=f"{wanted:#04x}")
            raise UserError(f"{port}: {words}")
