"""Builds the firmware with PlatformIO and flashes it through the board's bootloader."""

from greywhale.flash.flash import BOARDS, flash

__all__ = ["BOARDS", "flash"]
