"""A newer Nano on the bench: its bootloader is the real optiboot."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from greywhale.board.flash.images import read_pieces
from greywhale_sim import assemble
from greywhale_sim.wiring import BOARDS, NANO
from tests.board.flash.hex_files import hex_text

OPTIBOOT = Path(__file__).with_name("bootloaders") / "optiboot.hex"
BAUD = 115200


def fit_optiboot(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Give the bench's Nano optiboot, which first flashes its LED and loses questions meanwhile.

    Debian's build is too large for its place; it runs anywhere, and further down it has room.
    """
    code = read_pieces(OPTIBOOT)[0][1]
    moved = folder / "optiboot.hex"
    moved.write_text(hex_text(code, start=0x7C00))
    nano = replace(NANO, bootloader=moved, bootloader_baud=BAUD)
    monkeypatch.setattr(assemble, "BOARDS", {**BOARDS, "nano": nano})
