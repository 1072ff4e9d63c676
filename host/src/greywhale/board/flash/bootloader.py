"""Finds the speed of a Nano's bootloader: two kinds are sold that look alike from outside.

Asked directly it takes a second; avrdude itself needs a minute to give up at the wrong speed.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

import serial

from greywhale.errors import UserError
from greywhale.protocol.transport import open_serial

# STK500: "get sync" and "end of command"; the answer is "in sync", "ok".
_ASK = b"\x30\x20"
_ANSWER = b"\x14\x10"
_ASK_EVERY_S = 0.05
# A bootloader that listens answers the first question; both kinds listen for at least half a second after the reset.
_TRY_S = 0.5
_ROUNDS = 3


def find_speed(port: str, bauds: Sequence[int]) -> int:
    """The speed at which a bootloader answers; each opening of the port resets the board."""
    for _ in range(_ROUNDS):
        for baud in bauds:
            if _answers(port, baud):
                return baud
    tried = " and ".join(map(str, bauds))
    raise UserError(
        f"{port}: no bootloader answers at {tried} baud; check that the board's reset works, "
        "or burn a bootloader with a programmer."
    )


def _answers(port: str, baud: int) -> bool:
    with open_serial(port, baud, _ASK_EVERY_S) as line:
        heard = b""
        end = time.monotonic() + _TRY_S
        try:
            while time.monotonic() < end:
                line.write(_ASK)
                heard += line.read(64)
                if _ANSWER in heard:
                    return True
        except (OSError, serial.SerialException):
            raise UserError(f"{port}: the port went away in the middle; check the cable and try again.") from None
    return False
