"""Limits of a model and of a board's table, and the voltage from which on the board expects a joint to move."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.base.limits import MEASURED_IN_SEARCHES, limit


@dataclass(frozen=True)
class ModelLimits:
    """Limits beyond which a model or a board's table is doubted; and the arm with looser gears beside the estimate."""

    gear_sigmas: float = limit(
        0.5, "standard deviations", "the second plant's gears are looser by so many", MEASURED_IN_SEARCHES
    )
    slow_spread: float = limit(
        0.5,
        "of the tracking error",
        "half of the allowed arms may follow slow reaches so differently",
    )
    quick_spread: float = limit(0.25, "of the tracking error", "the same of quick moves")
    same_supply: float = limit(0.02, "of the supply", "difference of the supplies of model and board")
    same_slope: float = limit(0.1, "of the slope", "of the slopes of their potentiometers")
    same_zero_rad: float = limit(0.1, "rad", "of their zero angles")
    same_value: float = limit(1e-3, "of the value", "of an arm and its own table: more was an edit")
    same_gap_rad: float = limit(1e-5, "rad", "the same of gaps")


@dataclass(frozen=True)
class TravelLimits:
    """From which voltage on a joint must move, by the model."""

    sigmas: float = limit(3.0, "standard deviations", "of what the model leaves open, added to the friction")
    least_margin: float = limit(0.25, "of the friction", "added at least: friction differs from day to day")
    least_v: float = limit(0.3, "V", "0 would mean that nothing is known")
    max_supply_share: float = limit(
        0.8,
        "of the supply",
        "at most: a joint that stands gets all in the end",
    )
