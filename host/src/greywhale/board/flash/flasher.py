"""Flashes a board: finds out which one it is, writes an image for it, and greets the new firmware.

Success so means that the new firmware runs.
"""

from __future__ import annotations

from pathlib import Path

from greywhale.base import sentences
from greywhale.base.errors import BadUsage, UserError
from greywhale.base.types import Progress, show_no_progress
from greywhale.board.device import Device
from greywhale.board.flash import platformio
from greywhale.board.flash.bootloader import Bootloader, Dialect, find_bootloader
from greywhale.board.flash.images import Image, check_image, packaged_image, read_image
from greywhale.board.flash.pages import write_image
from greywhale.board.flash.rules import BOARDS
from greywhale.board.flash.targets import FlashBoard
from greywhale.board.session import Session
from greywhale.protocol import schema
from greywhale.protocol.ports import board_of


def flash(
    port: str,
    board: str | None = None,
    firmware_dir: str | Path | None = None,
    hex_file: str | Path | None = None,
    report: Progress = show_no_progress,
) -> schema.HelloReply:
    """Flash the board on `port` and return the new firmware's greeting.

    `board` is mega or nano; without it the port or the bootloader tells. The image is `hex_file`, else it is built from
    `firmware_dir`, else it is that of the checkout this package runs from, else the one that came with the package.
    """
    expected = _expected_board(port, board)
    image = None if hex_file is None else read_image(Path(hex_file))
    sources = platformio.find_sources(firmware_dir) if image is None else None
    with Session.of(port):  # also while this process has the port closed
        report("looking for the bootloader", 0.0)
        name, found = find_board(port, expected)
        target = BOARDS[name]
        if sources is not None:  # nothing is erased before there is something to write
            image = platformio.current_build(sources, target) if firmware_dir is None else None
            image = image or read_image(platformio.build(sources, target, report))
        image = image or _packaged(name)
        check_image(image, target, port)
        write_image(port, found.dialect, image, target.page, report)
        report("greeting the firmware", 0.0)
        return _greet(port, name)


def _expected_board(port: str, named: str | None) -> str | None:
    """The board that was named, else what the port says of itself without being opened."""
    if named is not None and named not in BOARDS:
        raise BadUsage(f"board {named!r} is unknown; choose one of {', '.join(BOARDS)}.")
    known = board_of(port)
    if named is not None and known is not None and named != known:
        raise BadUsage(
            f"{port}: this port belongs to an {BOARDS[known].title}, not to an {BOARDS[named].title}; "
            "leave --board out, or choose another port."
        )
    return named or known


def find_board(port: str, expected: str | None) -> tuple[str, Bootloader]:
    """The name of the board whose bootloader answers, and that; it must be the expected one."""
    names = [expected] if expected is not None else list(BOARDS)
    likely = [dialect for name in names for dialect in _dialects(BOARDS[name])]
    others = [dialect for board in BOARDS.values() for dialect in _dialects(board) if dialect not in likely]
    found = find_bootloader(port, likely, others)
    name = _name_of(port, found)
    if expected is not None and name != expected:
        raise BadUsage(
            f"{port}: the bootloader of an {BOARDS[name].title} answers, not that of an {BOARDS[expected].title}; "
            f"choose --board {name}, or another port."
        )
    return name, found


def _dialects(board: FlashBoard) -> list[Dialect]:
    return [Dialect(board.version, baud) for baud in board.bauds]


def _name_of(port: str, found: Bootloader) -> str:
    """The board by its chip, or by the way it speaks where it does not tell its chip."""
    for name, board in BOARDS.items():
        if found.signature == board.signature or (found.signature is None and found.dialect.version == board.version):
            return name
    assert found.signature is not None
    known = " and ".join(f"{board.title} ({board.signature.hex()})" for board in BOARDS.values())
    signature = f"signature {found.signature.hex()}"
    raise UserError(f"{port}: {sentences.OTHER_CHIP.format(signature=signature, known=known)}")


def _packaged(name: str) -> Image:
    path = packaged_image(name)
    if path is None:
        raise BadUsage(
            f"this installation of greywhale holds no firmware for an {BOARDS[name].title}; name the firmware folder "
            "of a checkout with --firmware, or a file with --hex."
        )
    return read_image(path)


def _greet(port: str, name: str) -> schema.HelloReply:
    with Device(port) as device:
        hello = device.hello
    if hello.board is not BOARDS[name].identity:
        raise UserError(
            f"{port}: flashed for {name}, but the firmware says it was built for {hello.board.description}; "
            "give a HEX file that was built for this board."
        )
    return hello
