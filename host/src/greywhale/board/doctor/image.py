"""The firmware on the board, read back through the bootloader, against the image that it should be."""

from __future__ import annotations

from greywhale.board.doctor.finding import Finding, Verdict
from greywhale.board.flash.readback import Comparison

_CHECK = "image"


def examine_comparison(found: Comparison) -> Finding:
    """Whether every byte is that of the image; the first that is not is told by its address."""
    if found.same:
        return Finding(
            _CHECK, Verdict.GOOD, f"All {found.compared:,} bytes of {found.path.name} are on the board, byte by byte."
        )
    return Finding(
        _CHECK,
        Verdict.BAD,
        f"{found.differing:,} of {found.compared:,} bytes are not those of {found.path}, the first at address "
        f"{found.first:#06x}: {found.found:#04x} instead of {found.wanted:#04x}.",
        "Flash this host's firmware with `greywhale flash`; if bytes differ again, replace the board.",
    )


def refused() -> Finding:
    """The motors are on: a restart would let the arm fall in the middle of its work."""
    return Finding(
        _CHECK, Verdict.BAD, "Not read back: the motors are on, and the board would restart.", "Run `greywhale stop`."
    )


def unread(why: str) -> Finding:
    """It could not be read back."""
    return Finding(_CHECK, Verdict.BAD, f"Not compared: {why}", "Try again; if it stays so, `greywhale flash`.")
