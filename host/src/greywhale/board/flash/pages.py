"""Writes an image into a board's program memory through its bootloader, and reads the memory back.

The Mega's bootloader erases one page after the other from the first on, whichever page is written. So a page behind a
gap of the image would be written over what an old program left there, or be erased after it was written.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from greywhale.base.errors import UserError
from greywhale.base.types import Progress
from greywhale.board.flash.bootloader import Dialect, enter_bootloader
from greywhale.board.flash.images import ERASED, Image
from greywhale.board.flash.stk500 import Stk500
from greywhale.protocol.transport import PortDisturbedError, PortLostError

_ATTEMPTS = 3
_NOTHING = 2 * ERASED  # a word that changes nothing wherever it is written, but a page is erased for it


class Memory:
    """The program memory behind a bootloader, which is asked again where a byte was lost on the way."""

    def __init__(self, port: str, line: Stk500) -> None:
        self.port, self.line = port, line

    def write(self, address: int, content: bytes) -> None:
        for _ in range(_ATTEMPTS):
            if self.line.write(address, content):
                return
            self.line.enter()
        raise self._silent(address)

    def read(self, block: range) -> bytes:
        """A page at most."""
        for _ in range(_ATTEMPTS):
            found = self.line.read(block.start, len(block) + len(block) % 2)  # whole words
            if found is not None:
                return found[: len(block)]
            self.line.enter()
        raise self._silent(block.start)

    def read_all(self, blocks: Sequence[range], what: str, report: Progress) -> Iterator[bytes]:
        for done, block in enumerate(blocks, start=1):
            yield self.read(block)
            report(what, done / len(blocks))

    def _silent(self, address: int) -> UserError:
        return UserError(
            f"{self.port}: the bootloader stopped answering at address {address:#x}; check the cable and try again."
        )


def write_image(port: str, dialect: Dialect, image: Image, size: int, report: Progress) -> None:
    """Write the image in pages of this size, read all of it back, and let the board start it."""
    try:
        with enter_bootloader(port, dialect) as line:
            memory = Memory(port, line)
            held = held_blocks(image, size)
            pages = blocks_of(image, size) if _must_erase_gaps(memory, image, held, size) else held
            for done, page in enumerate(pages, start=1):
                memory.write(page.start, image.content(page).ljust(size, ERASED) if page in held else _NOTHING)
                report("writing", done / len(pages))
            for page, found in zip(held, memory.read_all(held, "verifying", report), strict=True):
                _require(port, image, page, found)
            line.leave()
    except PortLostError:
        raise UserError(f"{port} went away while it was being flashed; connect the board and flash it again.") from None
    except PortDisturbedError as disturbed:
        disturbed.add_note("The board was not flashed whole: flash it again.")
        raise


def blocks_of(image: Image, size: int) -> list[range]:
    return [range(start, min(start + size, image.end)) for start in range(0, image.end, size)]


def held_blocks(image: Image, size: int) -> list[range]:
    """The blocks that the image has something for; what it leaves out is never executed."""
    return [block for block in blocks_of(image, size) if image.content(block).strip(ERASED)]


def _must_erase_gaps(memory: Memory, image: Image, held: Sequence[range], size: int) -> bool:
    """Whether a page behind a gap would not keep what is written there."""
    late = [page for place, page in enumerate(held) if page.start != place * size]
    if not (memory.line.erases_in_order and late):
        return False
    if late[0].start < len(held) * size:  # its turn to be erased comes after it was written
        return True
    return any(memory.read(page) not in (image.content(page), ERASED * len(page)) for page in late)


def _require(port: str, image: Image, page: range, found: bytes) -> None:
    for at, wanted, holds in zip(page, image.content(page), found, strict=True):
        if wanted != holds:
            raise UserError(
                f"{port}: the board holds {holds:#04x} at address {at:#x} instead of {wanted:#04x}; flash it again."
            )
