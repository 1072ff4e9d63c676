"""The boards that can be flashed: how PlatformIO builds for each, how its bootloader speaks, what its chip is."""

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


# Nanos are sold with two bootloaders that look alike from outside: which speed it is must be found out.
BOARDS = {
    "mega": FlashBoard(
        environment="megaatmega2560",
        version=2,
        bauds=(115200,),
        signature=b"\x1e\x98\x01",
        page=256,
        space=253952,
        flash=262144,
        identity=schema.Board.MEGA2560,
    ),
    "nano": FlashBoard(
        environment="nanoatmega328",
        version=1,
        bauds=(115200, 57600),
        signature=b"\x1e\x95\x0f",
        page=128,
        space=30720,
        flash=32768,
        identity=schema.Board.NANO328,
    ),
}
