"""Puts the firmware onto a board through its bootloader: one that PlatformIO builds, or the one that came along."""

from greywhale.board.flash.flasher import flash
from greywhale.board.flash.images import packaged_image
from greywhale.board.flash.rules import BOARDS

__all__ = ["BOARDS", "flash", "packaged_image"]
