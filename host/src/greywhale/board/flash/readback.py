"""Reads a board's program memory through its bootloader, and compares it byte by byte with an image.

Nothing is written. The board restarts into its bootloader first, and into its firmware at the end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from greywhale.base.errors import BadUsage
from greywhale.base.types import Progress, show_no_progress
from greywhale.board.flash.boot_code import BootCode, look_at_boot_code
from greywhale.board.flash.bootloader import enter_bootloader
from greywhale.board.flash.flasher import find_board
from greywhale.board.flash.images import Image, check_image, packaged_image, read_image
from greywhale.board.flash.pages import Memory, held_blocks
from greywhale.board.flash.platformio import find_sources, last_build
from greywhale.board.flash.rules import BOARDS


@dataclass(frozen=True)
class Comparison:
    """An image against a board's memory: bytes compared, how many differ, where first, and both bytes there."""

    path: Path
    compared: int
    differing: int = 0
    first: int | None = None
    wanted: int | None = None
    found: int | None = None

    @property
    def same(self) -> bool:
        return self.differing == 0


def shipped_image(board: str) -> Image:
    """The image that this greywhale flashes: the one that came with it, or the last build of a checkout."""
    path = packaged_image(board)
    if path is None:
        sources = find_sources(None)
        path = None if sources is None else last_build(sources, BOARDS[board])
    if path is None:
        raise BadUsage(
            f"this greywhale has no image for an {BOARDS[board].title} to compare with; name one with --hex, or build "
            "it with `greywhale flash`."
        )
    return read_image(path)


def compare_image(
    port: str, hex_file: Path | None = None, report: Progress = show_no_progress
) -> tuple[Comparison, BootCode]:
    """Read back what the board holds and compare it with `hex_file`, or with the shipped image of that board; and look
    at its bootloader."""
    named = None if hex_file is None else read_image(hex_file)
    name, found = find_board(port, None)
    board = BOARDS[name]
    image = named or shipped_image(name)
    check_image(image, board, port)
    held = held_blocks(image, board.page)
    boot = [range(start, start + board.page) for start in range(board.space, board.flash, board.page)]
    with enter_bootloader(port, found.dialect) as line:
        memory = b"".join(Memory(port, line).read_all([*held, *boot], "reading the program memory", report))
        line.leave()
    count = sum(map(len, held))
    return compare(image, held, memory[:count]), look_at_boot_code(found, memory[count:])


def compare(image: Image, held: Sequence[range], memory: bytes) -> Comparison:
    """An image against the memory at these addresses of it."""
    addresses = [*chain.from_iterable(held)]
    differing = [(at, found) for at, found in zip(addresses, memory, strict=True) if image.memory[at] != found]
    if not differing:
        return Comparison(image.path, len(memory))
    first, found = differing[0]
    return Comparison(image.path, len(memory), len(differing), first, image.memory[first], found)
