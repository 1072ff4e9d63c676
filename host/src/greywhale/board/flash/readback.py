"""Reads a board's program memory through its bootloader, and compares it byte by byte with an image.

Nothing is written. The board restarts into its bootloader first, and into its firmware at the end.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from greywhale.base.errors import BadUsage, UserError
from greywhale.base.types import Progress, show_no_progress
from greywhale.board.flash.boot_code import BootCode, look_at_boot_code
from greywhale.board.flash.bootloader import (
    Bootloader,
    Talk,
    enter_bootloader,
    read_version_2,
    version_1_answer,
    version_2_answer,
)
from greywhale.board.flash.flasher import find_board
from greywhale.board.flash.images import Image, check_image, packaged_image, read_image
from greywhale.board.flash.platformio import find_sources, last_build
from greywhale.board.flash.targets import BOARDS

# Reads so many bytes from a word address on; None where the answer was wrong.
_Reader = Callable[[Talk, int, int], bytes | None]

BLOCK = 128  # bytes; all bootloaders give so many at once
_ATTEMPTS = 3


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
    held = held_blocks(image)
    boot = [range(start, start + BLOCK) for start in range(board.space, board.flash, BLOCK)]
    memory = read_flash(port, found, [*held, *boot], report)
    count = sum(map(len, held))
    return compare(image, held, memory[:count]), look_at_boot_code(found, memory[count:])


def held_blocks(image: Image) -> list[range]:
    """The addresses that the image has something for; what it leaves out is never executed."""
    blocks = [range(start, min(start + BLOCK, image.end)) for start in range(0, image.end, BLOCK)]
    return [block for block in blocks if image.memory[block.start : block.stop].strip(b"\xff")]


def compare(image: Image, held: Sequence[range], memory: bytes) -> Comparison:
    """An image against the memory at these addresses of it."""
    addresses = [*chain.from_iterable(held)]
    differing = [(at, found) for at, found in zip(addresses, memory, strict=True) if image.memory[at] != found]
    if not differing:
        return Comparison(image.path, len(memory))
    first, found = differing[0]
    return Comparison(image.path, len(memory), len(differing), first, image.memory[first], found)


def read_flash(port: str, bootloader: Bootloader, blocks: Sequence[range], report: Progress) -> bytes:
    """The program memory at these addresses, `BLOCK` at most each. The board's firmware is started again afterwards."""
    memory = b""
    with enter_bootloader(port, bootloader.dialect) as line:
        read, leave = _READERS[bootloader.dialect.programmer]
        for done, block in enumerate(blocks, start=1):
            memory += _read_block(port, line, read, block.start, len(block))
            report("reading the program memory", done / len(blocks))
        leave(line)
    return memory


def _read_block(port: str, line: Talk, read: _Reader, address: int, count: int) -> bytes:
    for _ in range(_ATTEMPTS):
        # Bootloaders read whole words.
        block = read(line, address // 2, count + count % 2)
        if block is not None:
            return block[:count]
        line.forget()
    raise UserError(f"{port}: the bootloader stopped answering at address {address:#x}; check the cable and try again.")


def _read_1(line: Talk, word: int, count: int) -> bytes | None:
    line.write(b"U" + word.to_bytes(2, "little") + b" ")
    if version_1_answer(line, 0) is None:
        return None
    line.write(b"t" + count.to_bytes(2, "big") + b"F ")
    return version_1_answer(line, count)


def _leave_1(line: Talk) -> None:
    line.write(b"Q ")
    version_1_answer(line, 0)


def _leave_2(line: Talk) -> None:
    version_2_answer(line, b"\x11\x01\x01")


_READERS: dict[str, tuple[_Reader, Callable[[Talk], None]]] = {
    "arduino": (_read_1, _leave_1),
    "wiring": (read_version_2, _leave_2),
}
