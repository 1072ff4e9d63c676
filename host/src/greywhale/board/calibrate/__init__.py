"""From potentiometers mounted anyhow to angles: sweeps and poses by hand, zero, scale, limits, mistakes by name."""

from __future__ import annotations

from greywhale.board.calibrate.guide import Options, Result, calibrate
from greywhale.board.calibrate.person import Guide, PersonAnswer

__all__ = ["Guide", "Options", "PersonAnswer", "Result", "calibrate"]
