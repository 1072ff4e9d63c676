"""Erases the pages that avrdude would write without erasing them.

The Mega's bootloader erases one page after the other from the first on, whichever page is written. avrdude leaves out
pages of which an image has nothing. So a page behind such a gap would be written over what an old program left there.
"""

from __future__ import annotations

from greywhale.base.errors import UserError
from greywhale.base.types import Progress
from greywhale.board.flash.bootloader import Bootloader, Talk, enter_bootloader, read_version_2, version_2_answer
from greywhale.board.flash.images import Image

_PAGE = 256  # bytes
# A word of nothing, which changes nothing wherever it is written. How to write it the bootloader knows by itself.
_WRITE_NOTHING = bytes([0x13, 0, 2, 0xC1, 10, 0x40, 0x4C, 0x20, 0, 0, 0xFF, 0xFF])


def erase_late_pages(port: str, bootloader: Bootloader, image: Image, report: Progress) -> None:
    """Erase all pages up to the image's end, where one behind a gap holds something else."""
    pages = [image.memory[at : at + _PAGE] for at in range(0, image.end, _PAGE)]
    held = [number for number, page in enumerate(pages) if page.strip(b"\xff")]
    late = [number for place, number in enumerate(held) if number != place]
    if bootloader.dialect.programmer != "wiring" or not late:
        return
    with enter_bootloader(port, bootloader.dialect) as line:
        if all(_is_free(line, number, pages[number]) for number in late):
            return
        for number in range(len(pages)):
            if version_2_answer(line, _WRITE_NOTHING) != b"\x13\x00":
                raise UserError(
                    f"{port}: the bootloader stopped answering at page {number}; check the cable, try again."
                )
            report("erasing", (number + 1) / len(pages))


def _is_free(line: Talk, number: int, page: bytes) -> bool:
    """Whether a page of the board can be written: it holds nothing, or the same already."""
    found = read_version_2(line, number * _PAGE // 2, _PAGE) or b""
    return found[: len(page)] in (page, b"\xff" * len(page))
