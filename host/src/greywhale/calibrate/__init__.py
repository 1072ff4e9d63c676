"""From potentiometers mounted anyhow to angles: sweeps and poses by hand, zero, scale, limits, mistakes by name."""

from __future__ import annotations

from greywhale.calibrate.guide import Guide, Options, Result, calibrate

__all__ = ["Guide", "Options", "Result", "calibrate"]
