"""The boards that can be flashed: how PlatformIO builds for each, how its bootloader speaks, what its chip is."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.protocol import schema


@dataclass(frozen=True)
class FlashBoard:
    """PlatformIO's environment, avrdude's part and programmer, the speeds of the bootloader; the chip's signature, and
    the bytes of flash that the bootloader leaves, and where its own end.
    """

    environment: str
    part: str
    programmer: str
    bauds: tuple[int, ...]
    signature: bytes
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
        part="atmega2560",
        programmer="wiring",
        bauds=(115200,),
        signature=b"\x1e\x98\x01",
        space=253952,
        flash=262144,
        identity=schema.Board.MEGA2560,
    ),
    "nano": FlashBoard(
        environment="nanoatmega328",
        part="atmega328p",
        programmer="arduino",
        bauds=(115200, 57600),
        signature=b"\x1e\x95\x0f",
        space=30720,
        flash=32768,
        identity=schema.Board.NANO328,
    ),
}
