"""Limits of a joint's swings, by what it did before, for a commissioning and an adaptation alike; of a visit of a pose;
and of all that a log is measured by.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from greywhale.base.limits import BY_DEFINITION, MEASURED_IN_TRIALS, limit
from greywhale.base.types import Floats
from greywhale.measure.swings import Hunting


@dataclass(frozen=True)
class SwingBounds:
    """From where on a swing counts, whatever was there before."""

    limit_cycle_rad: float = limit(0.01, "rad", "turns farther apart are a limit cycle in a rest")
    limit_cycle_turns: int = limit(3, "turns", "so many turns in one rest are a limit cycle")
    search_cycle_rad: float = limit(0.005, "rad", "turns that are nearer already cost a search something")
    search_cycle_turns: int = limit(2, "turns", "fewer turns too")
    chatter_at_rest_hz: float = limit(50.0, "1/s", "more large swings of the voltage at rest are chatter")
    chatter_moving_hz: float = limit(100.0, "1/s", "a gear that moves bears more of them")
    rattle_moving_rad: float = limit(0.005, "rad rms", "a joint that rattles more while it moves fails")
    quiet_share: float = limit(0.03, "of the supply", "so much ripple is allowed at rest in any case")

    @property
    def limit_cycle(self) -> Hunting:
        """In simulations, and in a log that ended in hunting."""
        return Hunting(self.limit_cycle_rad, self.limit_cycle_turns)

    @property
    def search_cycle(self) -> Hunting:
        """The hunting that a search already pays for."""
        return Hunting(self.search_cycle_rad, self.search_cycle_turns)


@dataclass(frozen=True)
class SwingLimits:
    """Limits of a joint's swings beside those before. `measure/swings.py` says what each kind of swinging is."""

    max_unrest_rad: float = limit(0.005, "rad rms", "more anybody sees, unless it was there before")
    unseen_unrest_rad: float = limit(
        0.0015,
        "rad rms",
        "less nobody sees; other motions show up to twice the check's",
    )
    unseen_rattle_rad: float = limit(0.003, "rad rms", "less rattling nobody sees")
    unrest_growth: float = limit(1.5, "times before", "unrest may grow so much, between the two sizes above")
    rattle_growth: float = limit(2.0, "times before", "rattling may grow so much, up to what a moving joint may rattle")
    voltage_growth: float = limit(
        1.1,
        "times before",
        "chatter and ripple; the same controllers differ by some per cent",
        MEASURED_IN_TRIALS,
    )
    repeat_share: float = limit(
        0.04,
        "of before",
        "99 of 100 pairs with the same controllers differ by less",
        MEASURED_IN_TRIALS,
    )
    bearable_excess: float = limit(
        1.15,
        "times the limit",
        "swings differ from trial to trial; up to this one of them can be borne",
        MEASURED_IN_TRIALS,
    )

    bounds: SwingBounds = SwingBounds()


@dataclass(frozen=True)
class RepeatabilityLimits:
    """Conditions for a visit of a pose, and for coming from a side."""

    same_pose_rad: float = limit(0.05, "rad", "rests of the leader no farther apart are one pose")
    approach_rad: float = limit(0.05, "rad", "a joint comes from the side where its leader last was farther away")
    averaged_s: float = limit(0.25, "s", "the end of a rest, averaged: over two periods of a tremor")
    calm_rad: float = limit(1e-3, "rad", "a leader farther from its rest's middle begins to leave it")
    calm_spreads: float = limit(4.0, "times its median distance", "or, one that trembles, farther than this")
    still_rad: float = limit(0.02, "rad", "a follower that moves more has not come to rest")
    least_visits: int = limit(2, "visits", "a standard deviation needs so many", BY_DEFINITION)


@dataclass(frozen=True)
class StepLimits:
    """A step of the leader out of a rest, and its answer."""

    onset_rad: float = limit(0.05, "rad", "a joint farther from where it rested has left, as in the paper")
    step_rad: float = limit(0.15, "rad", "a leader that gets farther makes a step")
    step_s: float = limit(0.5, "s", "within this time")
    settled_share: float = limit(0.05, "of the step", "the follower has settled within this to either side")
    smooth_s: float = limit(0.02, "s", "angles are averaged over it: a single noisy sample is no overshoot")
    more_percent: float = limit(5.0, "% of the step", "more overshoot than before is no chance")


@dataclass(frozen=True)
class DelayLimits:
    """The search for the lag at which a follower resembles its leader most."""

    least_motion_rad: float = limit(0.05, "rad", "a joint that moves less shows noise rather than a delay")
    least_correlation: float = limit(0.5, "", "below, the follower does not follow in any useful sense")
    before_zero_s: float = limit(0.1, "s", "lags below 0 only tell a peak at 0 from the edge of the search")
    longest_s: float = limit(1.0, "s", "no longer lag is searched")
    shortest_overlap_s: float = limit(1.0, "s", "at the longest lag the two must still overlap for so long")


@dataclass(frozen=True)
class FollowingLimits:
    """Conditions for telling that a joint does not follow at all."""

    least_motion_rad: float = limit(0.3, "rad", "worn teeth and soft controllers hide up to half of it")
    delays_s: tuple[float, ...] = limit((0.0, 0.1, 0.2, 0.3), "s", "a healthy joint answers by one of these")
    least_share: float = limit(0.1, "of the variance", "a follower that takes less off its leader's does not follow")


@dataclass(frozen=True)
class HuntingLimits:
    """Hunting in a log and in what a model makes of it."""

    piece_s: float = limit(0.5, "s", "swings are looked at in pieces of this length")
    leader_rad: float = limit(5e-3, "rad", "in which the leader makes no larger ones")
    hunting_rad: float = limit(5e-3, "rad rms", "a joint hunts in a piece in which it swings more")
    hunting_share: float = limit(0.1, "of the pieces", "and in the log with this share of such pieces, not one alone")
    alike: float = limit(2.0, "times", "a model swings as the log does within this factor")


@dataclass(frozen=True)
class EvaluationLimits:
    """All limits by which a log is measured."""

    steps: StepLimits = StepLimits()
    delay: DelayLimits = DelayLimits()
    following: FollowingLimits = FollowingLimits()
    hunting: HuntingLimits = HuntingLimits()


EVALUATION_LIMITS = EvaluationLimits()
STEPS, DELAY = EVALUATION_LIMITS.steps, EVALUATION_LIMITS.delay
FOLLOWING, HUNTING = EVALUATION_LIMITS.following, EVALUATION_LIMITS.hunting
REPEATABILITY_LIMITS = RepeatabilityLimits()
SWING_LIMITS = SwingLimits()
SWING_BOUNDS = SWING_LIMITS.bounds


@dataclass(frozen=True)
class AllowedSwings:
    """The most that each joint may swing, (rows, 4) each: a row is a part of a check, or a record as a whole."""

    unrest: Floats  # rad rms
    rattle: Floats  # rad rms
    chatter: Floats  # 1/s
    ripple: Floats  # V rms

    @classmethod
    def beside(
        cls,
        unrest: Floats,
        rattle: Floats,
        chatter: Floats,
        ripple: Floats,
        quiet_v: float,
        limits: SwingLimits = SWING_LIMITS,
        *,
        growth: Floats | None = None,
        unseen_unrest: Floats | None = None,
        unseen_rattle: Floats | None = None,
    ) -> AllowedSwings:
        """From what was measured before, (rows, 4) each, NaN where there is none. What was there before is never too
        much, nor is ripple of `quiet_v`. Growth and what nobody sees may differ from row to row.
        """
        if growth is None:
            growth = np.full(unrest.shape, limits.unrest_growth)
        least_unrest = limits.unseen_unrest_rad if unseen_unrest is None else unseen_unrest
        least_rattle = limits.unseen_rattle_rad if unseen_rattle is None else unseen_rattle
        most_rattle = limits.bounds.rattle_moving_rad

        def allowed(before: Floats, grow: Callable[[Floats], Floats], least: Floats | float, most: float) -> Floats:
            known = np.nan_to_num(before)
            return np.maximum(np.clip(grow(known), least, most), known * (1.0 + limits.repeat_share))

        return cls(
            unrest=allowed(
                unrest, lambda known: _grow_beyond_noise(known, growth), least_unrest, limits.max_unrest_rad
            ),
            rattle=allowed(rattle, lambda known: limits.rattle_growth * known, least_rattle, most_rattle),
            chatter=np.maximum(limits.bounds.chatter_at_rest_hz, limits.voltage_growth * np.nan_to_num(chatter)),
            ripple=np.maximum(quiet_v, limits.voltage_growth * np.nan_to_num(ripple)),
        )


def _grow_beyond_noise(unrest: Floats, growth: Floats) -> Floats:
    """The potentiometers' noise, which does not grow, is at most what the quietest joint shows in the same part."""
    seen = np.where(unrest > 0.0, unrest, np.inf).min(axis=1, keepdims=True)  # a joint that is not in use has none
    noise = np.where(np.isfinite(seen), seen, 0.0)
    grown: Floats = np.sqrt(noise**2 + growth**2 * np.maximum(unrest**2 - noise**2, 0.0))
    return grown
