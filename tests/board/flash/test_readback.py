"""Program memory read back through each kind of bootloader, and the first byte that differs from the image."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.board.flash.images import read_image
from greywhale.board.flash.readback import compare_image
from tests.board.flash.fake_bootloader import ATMEGA328P, MEGA2560, FakeBootloader, Version1, Version2
from tests.board.flash.hex_files import hex_text, write_image

BOTH = pytest.mark.parametrize(
    ("kind", "baud", "signature"), [(Version2, 115200, MEGA2560), (Version1, 57600, ATMEGA328P)], ids=["mega", "nano"]
)


def garble(asked: str, count: int) -> str:
    return "garbled" if asked == "read" and count < 2 else ""


@BOTH
def test_the_first_byte_that_differs_is_told_and_the_firmware_started_again(
    kind: type[FakeBootloader], baud: int, signature: bytes, tmp_path: Path
) -> None:
    path = write_image(tmp_path / "image.hex", signature)
    memory = bytearray(read_image(path).memory)
    with kind(baud, signature, bytes(memory), garble) as board:
        assert compare_image(board.port, path)[0].same
        assert board.left
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
    assert (found.compared, found.differing, found.first) == (Version2.page + 3, Version2.page - 100 + 1, 100)
