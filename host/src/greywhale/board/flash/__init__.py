"""Builds the firmware with PlatformIO and flashes it through the board's bootloader."""

from greywhale.board.flash.flasher import BOARDS, flash

__all__ = ["BOARDS", "flash"]
