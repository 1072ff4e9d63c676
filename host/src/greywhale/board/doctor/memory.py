"""The program memory, read back through the bootloader: the image that it should hold, and the bootloader's own code,
which says whether the board comes back from a hang.
"""

from __future__ import annotations

from greywhale.board.doctor.finding import Finding, Verdict
from greywhale.board.flash.boot_code import BootCode
from greywhale.board.flash.readback import Comparison

_IMAGE, _BOOTLOADER = "image", "bootloader"


def examine_comparison(found: Comparison) -> Finding:
    """A finding that says if every byte is that of the image, or the address of the first that is not."""
    if found.same:
        return Finding(
            _IMAGE, Verdict.GOOD, f"All {found.compared:,} bytes of {found.path.name} are on the board, byte by byte."
        )
    return Finding(
        _IMAGE,
        Verdict.BAD,
        f"{found.differing:,} of {found.compared:,} bytes are not those of {found.path}, the first at address "
        f"{found.first:#06x}: {found.found:#04x} instead of {found.wanted:#04x}.",
        "Flash this host's firmware with `greywhale flash`; if bytes differ again, replace the board.",
    )


def refused() -> Finding:
    """The motors are on: a restart would let the arm fall in the middle of its work."""
    return Finding(
        _IMAGE, Verdict.BAD, "Not read back: the motors are on, and the board would restart.", "Run `greywhale stop`."
    )


def unread(why: str) -> Finding:
    return Finding(_IMAGE, Verdict.BAD, f"Not compared: {why}", "Try again; if it stays so, `greywhale flash`.")


def examine_boot_code(found: BootCode) -> Finding:
    """Worth knowing where a hang leaves the board silent; its motors are off all the same."""
    if found.comes_back is None:
        return Finding(
            _BOOTLOADER, Verdict.NOTE, f"{found.title}; its code cannot be read, so nobody knows if it is sound."
        )
    if found.comes_back:
        return Finding(_BOOTLOADER, Verdict.GOOD, f"{found.title}; after a hang it starts the firmware again.")
    return Finding(
        _BOOTLOADER,
        Verdict.NOTE,
        f"{found.title}, an old one: after a hang with interrupts off the motors are off, but the board says nothing "
        "until its power is cut.",
        'To hear of such a hang, burn a newer bootloader with a programmer: see "Bootloaders" in docs/firmware.md.',
    )


def not_examined() -> Finding:
    """Without a restart nobody can look at it."""
    return Finding(_BOOTLOADER, Verdict.GOOD, "Not looked at: the board would have to restart (--image looks).")
