"""HEX files as people hand them over: whole, damaged, foreign, for the other board."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.board.flash.images import Record, read_image
from greywhale.board.flash.rules import BOARDS
from greywhale.protocol import schema
from tests.board.flash.hex_files import SOURCES, hex_text, image_record, record, write_image

MEGA, NANO = BOARDS["mega"], BOARDS["nano"]


def test_an_image_tells_chip_version_schema_and_sources(tmp_path: Path) -> None:
    image = read_image(write_image(tmp_path / "a.hex", MEGA.signature))
    assert image.end == 600
    assert image.record == Record(MEGA.signature, "3.2.1", schema.SCHEMA_HASH, SOURCES)


def test_addresses_above_64_kilobytes_are_understood(tmp_path: Path) -> None:
    path = tmp_path / "high.hex"
    path.write_text(hex_text(b"x" * 300, start=0x1FFF0))
    assert read_image(path).end == 0x1FFF0 + 300
    path.write_text(record(2, 0, b"\x10\x00") + record(0, 4, b"abc") + record(1, 0, b""))
    assert read_image(path).end == 0x10000 + 7


def test_an_image_of_somebody_else_has_no_record(tmp_path: Path) -> None:
    assert read_image(write_image(tmp_path / "a.hex")).record is None
    later = tmp_path / "later.hex"
    later.write_text(hex_text(image_record(NANO.signature, layout=2)))
    assert read_image(later).record is None
    cut = tmp_path / "cut.hex"
    cut.write_text(hex_text(image_record(NANO.signature)[:-1]))
    assert read_image(cut).record is None


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "ends too early"),
        (b":00000001FF\n", "holds no data"),
        (hex_text(b"some bytes").rsplit(":", 1)[0].encode(), "ends too early"),
        (b"\x7fELF\x01\x01\n:00000001FF\n", "line 1: this is no Intel HEX record"),
        (hex_text(b"some bytes").replace("73", "74", 1).encode(), "line 2: this is no Intel HEX record"),
        (b":0400\n", "line 1: this is no Intel HEX record"),
        ((record(4, 0, b"\x00\x10") + record(0, 0, b"x") + record(1, 0, b"")).encode(), "no board has as much memory"),
    ],
    ids=["empty", "only an end", "cut off", "an ELF", "a flipped digit", "a short line", "far too high"],
)
def test_a_damaged_file_is_named_with_its_line(content: bytes, words: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.hex"
    path.write_bytes(content)
    with pytest.raises(UserError, match=rf"bad\.hex.*{words}") as caught:
        read_image(path)
    assert caught.value.exit_code == 2
