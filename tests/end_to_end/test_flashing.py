"""The real firmware is written through the real bootloaders; boards with other firmware are told apart."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from greywhale.board import flash
from greywhale.board.flash import platformio
from greywhale.board.flash.bootloader import Bootloader, Dialect, find_bootloader
from greywhale.board.flash.images import read_image
from greywhale.board.flash.rules import BOARDS
from greywhale.cli.story import BenchProcess
from greywhale.protocol import schema
from greywhale.protocol.transport import BAUD, LINES, Line
from greywhale_sim.assemble import BUILDS
from greywhale_sim.words import lock_step
from tests.board.flash.hex_files import hex_text
from tests.board.flash.newer_nano import fit_optiboot

IMAGES = {name: BUILDS / board.environment / "firmware.hex" for name, board in flash.BOARDS.items()}
Start = Callable[..., BenchProcess]


@pytest.mark.slow
def test_flash_a_mega_that_an_old_program_fills(start_bench: Start, tmp_path: Path) -> None:
    """PlatformIO builds; the image's part behind its gap is erased before it is written."""
    (tmp_path / "old.hex").write_text(hex_text(bytes(0x20100)))  # what is not erased stays zero
    bench = start_bench("--firmware", str(tmp_path / "old.hex"))
    hello = flash.flash(bench.port, "mega", firmware_dir=platformio.CHECKOUT)
    assert (hello.schema_hash, hello.board) == (schema.SCHEMA_HASH, schema.Board.MEGA2560)


@pytest.mark.slow
@pytest.mark.parametrize("board", IMAGES)
def test_a_flash_that_was_interrupted_is_repeated(board: str) -> None:
    """Neither changes the EEPROM."""
    image = read_image(IMAGES[board]).memory

    def interrupt(what: str, fraction: float) -> None:
        if what == "writing" and fraction > 0.5:
            raise KeyboardInterrupt

    with lock_step("--blank", "--board", board) as bench:
        kept = bytes(at * 7 & 255 for at in range(len(bench.server.board.eeprom())))
        bench.server.board.set_eeprom(kept)
        with pytest.raises(KeyboardInterrupt):
            flash.flash(bench.port, board, hex_file=IMAGES[board], report=interrupt)
        assert bench.server.board.flash()[: len(image)] != image
        flash.flash(bench.port, board, hex_file=IMAGES[board])
        assert bench.server.board.flash()[: len(image)] == image
        assert bench.server.board.eeprom() == kept


class BadCable:
    """The line to a bench, which loses bytes of some pages on their way there, and of some on their way back."""

    def __init__(self, line: Line, lost: list[str], pages: list[int], count: int) -> None:
        """Losses and written pages are counted over all openings of the port; `count` bytes are lost at a time."""
        self.line, self.lost, self.pages, self.count = line, lost, pages, count
        self.restarted, self.close, self.clock, self.wait = line.restarted, line.close, line.clock, line.wait
        self._reads = False

    def write(self, data: bytes) -> None:
        self._reads = data[:1] == b"t" or data[5:6] == b"\x14"
        if len(data) > 100:
            self.pages.append(len(data))
            if len(self.pages) in (3, 20):
                self.lost.append("question")
                data = data[:50] + data[50 + self.count :]
        self.line.write(data)

    def read(self) -> bytes:
        data = self.line.read()
        if data and self._reads and self.lost.count("answer") < 2:
            self.lost.append("answer")
            self._reads = False
            data = data[self.count :]
        return data


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 40])
@pytest.mark.parametrize("board", IMAGES)
def test_bytes_that_are_lost_both_ways_do_no_harm(board: str, count: int) -> None:
    """In the middle of a page that is written, and in one that is read."""
    image, lost, pages = read_image(IMAGES[board]).memory, list[str](), list[int]()
    with lock_step("--blank", "--board", board) as bench, pytest.MonkeyPatch.context() as patch:
        start = LINES[bench.port]

        def open_badly(restart: bool, baud: int) -> Line:
            line = start(restart, baud)
            return line if baud == BAUD else BadCable(line, lost, pages, count)

        patch.setitem(LINES, bench.port, open_badly)
        flash.flash(bench.port, board, hex_file=IMAGES[board])
        assert bench.server.board.flash()[: len(image)] == image
    assert sorted(lost) == ["answer", "answer", "question", "question"]


@pytest.mark.slow
def test_flash_a_newer_nano(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fit_optiboot(tmp_path, monkeypatch)
    (tmp_path / "loop.hex").write_text(hex_text(b"\xff\xcf"))
    image = read_image(IMAGES["nano"]).memory
    with lock_step("--board", "nano", "--firmware", str(tmp_path / "loop.hex")) as bench:
        hello = flash.flash(bench.port, hex_file=IMAGES["nano"])
        assert hello.board is schema.Board.NANO328
        assert bench.server.board.flash()[: len(image)] == image
        new_nano = Bootloader(Dialect(1, 115200), BOARDS["nano"].signature)
        assert find_bootloader(bench.port, [new_nano.dialect], []) == new_nano
