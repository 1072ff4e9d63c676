"""avrdude writes the same image through the same bootloader: both boards hold the same afterwards, to the last byte.

Each reads back what the other wrote, and finds the same wrong byte in it.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from greywhale.board import flash
from greywhale.board.flash.images import read_image
from greywhale.board.flash.readback import compare_image
from greywhale.cli.story import BenchProcess
from greywhale_sim.assemble import BUILDS
from tests.board.flash.hex_files import hex_text

FLASH_BYTES = {"mega": 262_144, "nano": 32_768}
WORDS = {
    "mega": ("-c", "wiring", "-p", "atmega2560", "-b", "115200"),
    "nano": ("-c", "arduino", "-p", "atmega328p", "-b", "57600"),
}

WRONG = 0x1234  # the address of a byte that is not the image's


def run_avrdude(board: str, port: str, action: str) -> subprocess.CompletedProcess[str]:
    """Write, verify or read without erasing the chip."""
    command = ["avrdude", "-q", "-q", *WORDS[board], "-P", port, "-D", "-U", action]
    return subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)


def avrdude(board: str, port: str, action: str) -> None:
    done = run_avrdude(board, port, action)
    assert done.returncode == 0, done.stderr


def memory(board: str, port: str, path: Path) -> bytes:
    """All of the flash, the bootloader too, as avrdude reads it."""
    avrdude(board, port, f"flash:r:{path}:r")
    return path.read_bytes().ljust(FLASH_BYTES[board], b"\xff")


def with_wrong_byte(image: Path, path: Path) -> Path:
    """The beginning of an image, with another byte at `WRONG`."""
    content = bytearray(read_image(image).memory[:0x2000])
    content[WRONG] ^= 0xFF
    path.write_text(hex_text(bytes(content)))
    return path


@pytest.mark.parametrize("old", [0, 0x4000], ids=["blank", "with an old program"])
@pytest.mark.parametrize("board", WORDS)
def test_avrdude_and_greywhale_leave_the_same_memory(board: str, old: int, tmp_path: Path) -> None:
    """The old program is shorter: avrdude keeps what one left in the rest of the last page, greywhale erases it."""
    image = BUILDS / flash.BOARDS[board].environment / "firmware.hex"
    before = tmp_path / "before.hex"
    before.write_text(hex_text(bytes(old)))
    words = ["--board", board, "--speed", "max", *(("--firmware", str(before)) if old else ("--blank",))]
    other = with_wrong_byte(image, tmp_path / "other.hex")
    with BenchProcess(*words) as bench:
        flash.flash(bench.port, board, hex_file=image)
        avrdude(board, bench.port, f"flash:v:{image}:i")
        refused = run_avrdude(board, bench.port, f"flash:v:{other}:i")
        assert refused.returncode != 0
        assert f"{WRONG:#06x}" in refused.stderr
        ours = memory(board, bench.port, tmp_path / "ours")
    with BenchProcess(*words) as bench:
        avrdude(board, bench.port, f"flash:w:{image}:i")
        assert compare_image(bench.port, image)[0].same
        found, _ = compare_image(bench.port, other)
        assert (found.differing, found.first) == (1, WRONG)
        theirs = memory(board, bench.port, tmp_path / "theirs")
    assert len(ours) == FLASH_BYTES[board]
    assert ours == theirs
