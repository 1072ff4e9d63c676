"""A demo whose bench is in this process, in lock step, with its firmware on the board."""

from __future__ import annotations

from typing import Any

import pytest

from greywhale.board import flash
from greywhale.board.device import Device
from greywhale.cli.story import story
from greywhale.protocol.schema import HelloReply
from greywhale_sim.lockstep import LockStepBench
from greywhale_sim.words import lock_step


def in_this_process(patch: pytest.MonkeyPatch) -> None:
    """Flashing is left out: tests/end_to_end/test_flashing.py puts the firmware onto the board."""
    patch.setattr(story, "BenchProcess", flashed)
    patch.setattr(flash, "flash", greet)


def flashed(*words: str) -> LockStepBench:
    return lock_step(*(word for word in words if word != "--blank"))


def greet(port: str, *_: Any, **__: Any) -> HelloReply:
    with Device(port) as device:
        return device.hello
