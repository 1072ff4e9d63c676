"""Predicts from a bootloader's own code what it does after a reset by the watchdog.

Such a reset leaves the watchdog on, at 16 ms. A bootloader that does not look at the cause of the reset waits for a
host, and is reset while it waits, again and again until power is cut.
"""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.board.flash.bootloader import Bootloader
from greywhale.board.flash.images import ERASED

# `in Rd, MCUSR`, for any Rd. The register that holds the cause has the same address in both chips.
_READS_CAUSE, _ANY_REGISTER = 0xB604, 0x01F0


@dataclass(frozen=True)
class BootCode:
    """A bootloader in words, and whether it comes back from a hang, None where its code cannot be read."""

    title: str
    comes_back: bool | None


def look_at_boot_code(found: Bootloader, code: bytes) -> BootCode:
    """`code` is the section that the bootloader may fill, from an even address on."""
    words = (int.from_bytes(code[at : at + 2], "little") for at in range(0, len(code), 2))
    reads_cause = any(word & ~_ANY_REGISTER == _READS_CAUSE for word in words)
    title = f"STK500 version {found.dialect.version} at {found.dialect.baud} baud"
    return BootCode(title, reads_cause if code.strip(ERASED) else None)
