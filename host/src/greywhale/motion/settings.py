"""The thresholds that the measures share."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Settings:
    """Thresholds of the measures; angles in rad, times in s."""

    rest_s: float = 0.5
    rest_band: float = 0.02
    onset_band: float = 0.05
    step_size: float = 0.15
    step_s: float = 0.5
    longest_delay_s: float = 1.0
