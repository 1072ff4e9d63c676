"""A bootloader on a port is found by asking, and from its code alone whether it comes back from the watchdog."""

from __future__ import annotations

from pathlib import Path
from typing import Self

import pytest

from greywhale.base.errors import UserError
from greywhale.board.flash.boot_code import look_at_boot_code
from greywhale.board.flash.bootloader import Bootloader, Dialect, find_bootloader
from greywhale.board.flash.images import read_image
from greywhale_sim.wiring import BOOTLOADERS
from tests.board.flash.fake_bootloader import ATMEGA328P, MEGA2560, FakeBootloader, Version1, Version2

MEGA = Dialect(2, 115200)
NEW_NANO, OLD_NANO = Dialect(1, 115200), Dialect(1, 57600)


@pytest.mark.parametrize(
    ("kind", "signature", "dialect"),
    [(Version2, MEGA2560, MEGA), (Version1, ATMEGA328P, NEW_NANO), (Version1, ATMEGA328P, OLD_NANO)],
    ids=["mega", "new nano", "old nano"],
)
def test_each_bootloader_is_found_with_its_speed_and_its_chip(
    kind: type[FakeBootloader], signature: bytes, dialect: Dialect
) -> None:
    with kind(dialect.baud, signature) as line:
        assert find_bootloader(line.port, [MEGA, NEW_NANO, OLD_NANO], []) == Bootloader(dialect, signature)


def test_another_bootloader_than_the_likely_one_is_found_last() -> None:
    with Version2(115200, MEGA2560) as line:
        assert find_bootloader(line.port, [OLD_NANO], [MEGA]).dialect == MEGA
        assert line.heard == {57600, 115200}


def test_a_bootloader_that_does_not_tell_its_chip_is_found_all_the_same() -> None:
    class Silent(Version1):
        def answer(self, data: bytes) -> tuple[bytes, bytes]:
            return super().answer(data.replace(b"u ", b""))

    with Silent(57600, ATMEGA328P) as line:
        assert find_bootloader(line.port, [OLD_NANO], []) == Bootloader(OLD_NANO, None)


def test_a_board_without_bootloader_is_named() -> None:
    with Version1(9600, ATMEGA328P) as line:
        with pytest.raises(UserError, match="no bootloader answers at 115200 and 57600 baud"):
            find_bootloader(line.port, [NEW_NANO, OLD_NANO], [])
        assert line.heard == {115200, 57600}


def test_a_bootloader_that_flashes_its_led_first_is_not_flooded() -> None:
    """Optiboot looks at nothing for 375 ms and has room for two bytes; the chip starts 65 ms after its reset."""
    asked: list[float] = []

    class Busy(Version1):
        def open(self, restart: bool, baud: int) -> Self:
            self.opened = self.clock()
            return super().open(restart, baud)

        def write(self, data: bytes) -> None:
            assert len(data) == 2
            asked.append(self.clock() - self.opened)

    with Busy(115200, ATMEGA328P) as line, pytest.raises(UserError, match="no bootloader answers"):
        find_bootloader(line.port, [NEW_NANO], [])
    assert len(asked) == 6, "a question that is lost is repeated"
    for first, second in zip(asked[::2], asked[1::2], strict=True):
        assert first > 0.065
        assert second - first > 0.375
        assert second < 0.75, "it waits for a second"


OTHERS = Path(__file__).parent / "bootloaders"
FOUND = Bootloader(Dialect(1, 57600), None)


@pytest.mark.parametrize(
    ("path", "comes_back"),
    [
        (BOOTLOADERS / "nano.hex", False),
        (OTHERS / "diecimila.hex", False),
        (OTHERS / "pro_16MHz.hex", True),  # built to leave the watchdog's resets alone
        (OTHERS / "optiboot.hex", True),
        (BOOTLOADERS / "mega.hex", True),
    ],
    ids=lambda value: value.stem if isinstance(value, Path) else None,
)
def test_a_bootloader_that_looks_at_the_cause_comes_back(path: Path, comes_back: bool) -> None:
    code = read_image(path).memory.lstrip(b"\xff")
    assert look_at_boot_code(FOUND, code).comes_back is comes_back


def test_a_blank_section_tells_nothing() -> None:
    found = look_at_boot_code(FOUND, b"\xff" * 2048)
    assert (found.title, found.comes_back) == ("STK500 version 1 at 57600 baud", None)
