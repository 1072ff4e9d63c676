"""Limits of a log and of a leader's motion: what is doubted, what is refused, and what of a long log is used."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.base.limits import limit


@dataclass(frozen=True)
class UnitLimits:
    """Numbers that tell their unit."""

    enough_rows: int = limit(50, "rows", "fewer may be apart as they like, by chance")
    longer_ratio: float = limit(1.5, "times what the header says", "rows are usually no farther apart")
    shorter_ratio: float = limit(0.7, "times what the header says", "nor closer")
    same_unit_ratio: float = limit(1.05, "times", "so far a spacing may be from another unit's and still be in it")
    usual_s: tuple[float, float] = limit((2e-4, 0.2), "s", "no arm is seen at longer spacings, and no board is quicker")
    motion_rad: float = limit(0.1, "rad", "a motion of more")
    creep_rad_s: float = limit(0.02, "rad/s", "that never exceeds this speed is a thousandth of what a hand does")
    half_turn_rad: float = limit(3.15, "rad", "few joints turn farther from their zero")
    turn_rad: float = limit(6.3, "rad", "angles beyond a turn are in degrees")
    most_deg: float = limit(1000.0, "degrees", "if they are below this")


@dataclass(frozen=True)
class GapLimits:
    """Rows that are missing."""

    most_missing_samples: int = limit(10, "samples", "fewer in a row are no gap: a link may lose some")
    shortest_s: float = limit(1e-6, "s", "no two rows are closer, whatever times a file has")
    most_samples: float = limit(1e15, "samples", "nor does a gap count more")


@dataclass(frozen=True)
class MotorLimits:
    """Motors that drive, as a log's voltages show it."""

    least_v: float = limit(0.04, "V", "a smaller change moves no motor: it is less than a step of the PWM")
    off_s: float = limit(1.0, "s", "a motor without a voltage for longer, to either side, was off")
    motion_rad: float = limit(0.1, "rad", "a joint that stays within this does not move")
    most_changes_per_period: float = limit(1.2, "changes", "of a voltage: more are no chance")
    enough_changes: int = limit(100, "changes", "if there are so many in all")


@dataclass(frozen=True)
class SelectionLimits:
    """The part of a long log that is used: a log that moves all joints tells little more after it."""

    most_used_s: float = limit(60.0, "s", "a longer log is cut down to it, as identifying takes longer with it")
    piece_s: float = limit(5.0, "s", "it is cut into pieces of this length")
    step_s: float = limit(0.02, "s", "readings are averaged over this, so that speed is not noise")
    still_rad_s: float = limit(0.05, "rad/s", "a slower joint holds still against its voltage")
    pushed_v: float = limit(0.3, "V", "if that is larger")
    gap_periods: float = limit(1.5, "periods", "a longer spacing of rows is a gap")


@dataclass(frozen=True)
class LeaderLimits:
    """A motion that a leader may make."""

    longest_s: float = limit(3600.0, "s", "a longer motion has its times in another unit")
    fastest_rad_s: float = limit(250.0, "rad/s", "far beyond a hand; steps of `multi_steps` stay below")


UNITS = UnitLimits()
GAPS = GapLimits()
MOTORS = MotorLimits()
SELECTION = SelectionLimits()
LEADER = LeaderLimits()
