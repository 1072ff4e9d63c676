"""Which of the bootloaders that Debian ships come back from a reset by the watchdog, from their code alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.board.flash.boot_code import look_at_boot_code
from greywhale.board.flash.bootloader import Bootloader, Dialect
from greywhale.board.flash.images import read_image

SHIPPED = Path("/usr/share/arduino/hardware/arduino/avr/bootloaders")
FOUND = Bootloader(Dialect("arduino", 57600), None)


@pytest.mark.parametrize(
    ("path", "comes_back"),
    [
        ("atmega/ATmegaBOOT_168_atmega328.hex", False),
        ("atmega/ATmegaBOOT_168_diecimila.hex", False),
        ("atmega/ATmegaBOOT_168_pro_16MHz.hex", True),  # built to leave the watchdog's resets alone
        ("optiboot/optiboot_atmega328.hex", True),
        ("stk500v2/stk500boot_v2_mega2560.hex", True),
    ],
)
def test_a_bootloader_that_looks_at_the_cause_comes_back(path: str, comes_back: bool) -> None:
    code = read_image(SHIPPED / path).memory.lstrip(b"\xff")
    assert look_at_boot_code(FOUND, code).comes_back is comes_back


def test_a_blank_section_tells_nothing() -> None:
    found = look_at_boot_code(FOUND, b"\xff" * 2048)
    assert (found.title, found.comes_back) == ("STK500 version 1 at 57600 baud", None)
