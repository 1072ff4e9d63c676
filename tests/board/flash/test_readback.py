"""Program memory read back through each kind of bootloader, and the first byte that differs from the image."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.board.flash.bootloader import Bootloader, Dialect
from greywhale.board.flash.images import read_image
from greywhale.board.flash.readback import BLOCK, compare_image, read_flash
from tests.board.flash.fake_bootloader import ATMEGA328P, MEGA2560, FakeBootloader, Version1, Version2
from tests.board.flash.hex_files import hex_text, write_image

ON_MEGA, ON_NANO = (
    Bootloader(Dialect("wiring", 115200), MEGA2560),
    Bootloader(Dialect("arduino", 57600), ATMEGA328P),
)
BOTH = pytest.mark.parametrize(("kind", "found"), [(Version2, ON_MEGA), (Version1, ON_NANO)], ids=["mega", "nano"])
Kind = Callable[..., FakeBootloader]
MEMORY = bytes((7 * at + at // 256) % 256 for at in range(1001))


BLOCKS = [range(at, min(at + BLOCK, len(MEMORY))) for at in range(0, len(MEMORY), BLOCK)]


def told(what: str, fraction: float) -> None:
    assert 0.0 <= fraction <= 1.0


@BOTH
def test_every_byte_is_read_and_the_firmware_started_again(kind: Kind, found: Bootloader) -> None:
    with kind(found.dialect.baud, found.signature, MEMORY, garble=2) as board:
        assert read_flash(board.port, found, BLOCKS, told) == MEMORY
        assert board.left


@BOTH
def test_the_first_byte_that_differs_is_told(kind: Kind, found: Bootloader, tmp_path: Path) -> None:
    baud, signature = found.dialect.baud, found.signature
    path = write_image(tmp_path / "image.hex", signature)
    memory = bytearray(read_image(path).memory)
    with kind(baud, signature, bytes(memory)) as board:
        assert compare_image(board.port, path)[0].same
    memory[0x123] ^= 0x40
    memory[0x200] ^= 0x01
    with kind(baud, signature, bytes(memory)) as board:
        read, boot_code = compare_image(board.port, path)
    assert (read.same, read.differing, read.first, read.compared) == (False, 2, 0x123, len(memory))
    assert read.wanted is not None
    assert read.found == read.wanted ^ 0x40
    assert boot_code.comes_back is None, "its section is blank"


def test_what_an_image_leaves_out_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "gap.hex"
    path.write_text(hex_text(bytes(100)).rsplit(":", 1)[0] + hex_text(b"far", start=0x20000))
    with Version2(115200, MEGA2560, bytes(0x20000) + b"fat") as board:
        found, _ = compare_image(board.port, path)
    assert (found.compared, found.differing, found.first) == (BLOCK + 3, 29, 100)


def test_a_bootloader_that_answers_wrongly_again_and_again_is_named() -> None:
    with Version2(115200, MEGA2560, MEMORY, garble=99) as board, pytest.raises(UserError, match="at address 0x0"):
        read_flash(board.port, ON_MEGA, BLOCKS, told)
