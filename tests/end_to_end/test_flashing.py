"""The real firmware is written through the real bootloaders; boards with other firmware are told apart."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from greywhale.board import flash
from greywhale.board.flash.bootloader import Bootloader, Dialect, find_bootloader
from greywhale.cli.story import BenchProcess
from greywhale.protocol import schema
from greywhale_sim.assemble import BUILDS
from greywhale_sim.words import lock_step
from tests.board.flash.hex_files import hex_text

NANO_IMAGE = BUILDS / "nanoatmega328" / "firmware.hex"
Start = Callable[..., BenchProcess]


@pytest.mark.slow
def test_flash_a_mega_that_an_old_program_fills(start_bench: Start, tmp_path: Path) -> None:
    """PlatformIO builds; the image's part behind its gap is erased before it is written."""
    (tmp_path / "old.hex").write_text(hex_text(bytes(0x20100)))  # what is not erased stays zero
    bench = start_bench("--firmware", str(tmp_path / "old.hex"))
    hello = flash.flash(bench.port, "mega")
    assert (hello.schema_hash, hello.board) == (schema.SCHEMA_HASH, schema.Board.MEGA2560)


@pytest.mark.slow
def test_flash_a_blank_nano(start_bench: Start) -> None:
    bench = start_bench("--blank", board="nano")
    assert bench.command("status")["in_bootloader"]
    hello = flash.flash(bench.port, "nano", hex_file=NANO_IMAGE)
    assert (hello.schema_hash, hello.board) == (schema.SCHEMA_HASH, schema.Board.NANO328)
    assert not bench.command("status")["in_bootloader"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("board", "expected"),
    [
        ("mega", Bootloader(Dialect(2, 115200), b"\x1e\x98\x01")),
        ("nano", Bootloader(Dialect(1, 57600), b"\x1e\x95\x0f")),
    ],
)
def test_the_real_bootloaders_tell_their_board(board: str, expected: Bootloader) -> None:
    dialects = [Dialect(2, 115200), Dialect(1, 115200), Dialect(1, 57600)]
    with lock_step("--blank", "--board", board) as bench:
        assert find_bootloader(bench.port, dialects, []) == expected
