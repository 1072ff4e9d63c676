"""A demo whose bench is in this process, in lock step, with its firmware on the board."""

from __future__ import annotations

import pytest

from greywhale.board import flash
from greywhale.cli.story import story
from greywhale_sim.words import lock_step


def in_this_process(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(story, "BenchProcess", lock_step)
    patch.setattr(flash, "find_avrdude", lambda: None)
