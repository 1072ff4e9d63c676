"""The built images say the truth about themselves, and images of other sources are told apart."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import greywhale
from greywhale.board.flash.images import read_image
from greywhale.board.flash.rules import BOARDS
from greywhale.protocol import schema
from tools import ROOT

BUILD = ROOT / "firmware" / ".pio" / "build"
PARTS = ("src", "lib", "platformio.ini", "image_record.py", "source_digest.py", "strict_warnings.py")


def check(firmware: Path, *images: Path) -> subprocess.CompletedProcess[str]:
    """The words of that firmware folder's source_digest.py on the images."""
    command = [sys.executable, "-B", str(firmware / "source_digest.py"), *map(str, images)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """The firmware's sources in another place."""
    folder = tmp_path / "firmware"
    folder.mkdir()
    for part in PARTS:
        source = ROOT / "firmware" / part
        (shutil.copytree if source.is_dir() else shutil.copy)(source, folder / part)
    return folder


@pytest.mark.parametrize("board", BOARDS)
def test_an_image_names_its_chip_version_schema_and_sources(board: str) -> None:
    path = BUILD / BOARDS[board].environment / "firmware.hex"
    record = read_image(path).record
    assert record is not None
    assert record.signature == BOARDS[board].signature
    assert record.version == greywhale.__version__
    assert record.schema_hash == schema.SCHEMA_HASH
    assert check(ROOT / "firmware", path).returncode == 0


def test_the_place_of_the_sources_does_not_matter_but_every_file_does(copy: Path) -> None:
    image = BUILD / BOARDS["mega"].environment / "firmware.hex"
    assert check(copy, image).returncode == 0
    for changed in ("src/main.cpp", "lib/hal/src/avr/tick.cpp", "platformio.ini", "strict_warnings.py"):
        text = (copy / changed).read_text()
        (copy / changed).write_text(text + "\n")
        answer = check(copy, image)
        assert answer.returncode == 1
        assert (
            answer.stderr == f"{image} was built from other sources; run `make firmware`, or `pio run -d firmware`.\n"
        )
        (copy / changed).write_text(text)
    (copy / "src" / "main.cpp").rename(copy / "src" / "start.cpp")
    assert check(copy, image).returncode == 1


def test_an_image_that_is_missing_is_named(copy: Path) -> None:
    answer = check(copy, copy / "firmware.hex")
    assert answer.returncode == 1
    assert "firmware.hex is not built; run `make firmware`" in answer.stderr
