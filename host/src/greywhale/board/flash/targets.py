"""A board that can be flashed: how PlatformIO builds for it, how its bootloader speaks, what its chip is."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.protocol import schema


@dataclass(frozen=True)
class FlashBoard:
    """PlatformIO's environment, the version of STK500 that the bootloader speaks, and its speeds; the chip's signature,
    the bytes of a page, and of all flash that the bootloader leaves, and where its own end.
    """

    environment: str
    version: int
    bauds: tuple[int, ...]
    signature: bytes
    page: int
    space: int
    flash: int
    identity: schema.Board

    @property
    def title(self) -> str:
        return self.identity.description
