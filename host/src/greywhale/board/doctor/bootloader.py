"""The bootloader: whether the board comes back from a hang, and tells of it."""

from __future__ import annotations

from greywhale.board.doctor.finding import Finding, Verdict
from greywhale.board.flash.boot_code import BootCode

_CHECK = "bootloader"


def examine_boot_code(found: BootCode) -> Finding:
    """Worth knowing where a hang leaves the board silent; its motors are off all the same."""
    if found.comes_back is None:
        return Finding(_CHECK, Verdict.NOTE, f"{found.title}; its code cannot be read, so nobody knows if it is sound.")
    if found.comes_back:
        return Finding(_CHECK, Verdict.GOOD, f"{found.title}; after a hang it starts the firmware again.")
    return Finding(
        _CHECK,
        Verdict.NOTE,
        f"{found.title}, an old one: after a hang with interrupts off the motors are off, but the board says nothing "
        "until its power is cut.",
        'To hear of such a hang, burn a newer bootloader with a programmer: see "Bootloaders" in docs/firmware.md.',
    )


def not_examined() -> Finding:
    """Without a restart nobody can look at it."""
    return Finding(_CHECK, Verdict.GOOD, "Not looked at: the board would have to restart (--image looks).")
