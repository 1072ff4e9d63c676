"""Limits of a search: the motions that it trains on, the box that it searches, and the costs."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.base.limits import BY_DEFINITION, MEASURED_IN_SEARCHES, limit


@dataclass(frozen=True)
class TrainingLimits:
    """The motions that a search trains on."""

    edge_s: float = limit(0.04, "s", "a hand cannot jump")
    levels: tuple[float, ...] = limit(
        (0.0, 1.0, 0.9, 0.4, -0.6, -0.5, 0.0, -1.0, 0.0),
        "of the reach",
        "levels of the moves, rotated from joint to joint",
    )
    hold_s: float = limit(1.2, "s", "a level is held for so long")
    reach_rad: float = limit(1.0, "rad", "the moves go no farther to either side")
    clear_rad: float = limit(0.15, "rad", "this distance to limits and stops is kept")
    least_range_rad: float = limit(0.2, "rad", "a joint's range must have at least this much left")
    human_s: float = limit(9.0, "s", "of reaches in which every joint moves far")
    slow_s: float = limit(8.0, "s", "of slow following")
    slow_periods_s: tuple[float, ...] = limit((2.3, 4.1), "s", "slow following is a sum of waves of these periods")
    slow_shares: tuple[float, ...] = limit((0.4, 0.6), "of its size", "how large each of these waves is")
    slow_rad: float = limit(0.15, "rad", "their size is small beside the moves")
    ease_s: float = limit(0.4, "s", "each joint rests once in slow following, eased so")
    soon_s: float = limit(0.1, "s", "a moment weighs this and the time since the leader last moved")
    moving_rad: float = limit(0.02, "rad", "a leader that changes by this much moves")
    moving_s: float = limit(0.1, "s", "within this time")


@dataclass(frozen=True)
class SpaceLimits:
    """The box that is searched."""

    kp_range: tuple[float, float] = limit((0.1, 10.0), "1/rad", "Kp only stretches the axis of the sets")
    kd_range: tuple[float, float] = limit((1e-3, 5.0), "1/rad over 20 ms", "so does Kd")
    usual_kp: float = limit(1.0, "1/rad", "where sets are searched too: full ones reach to 1 rad")
    usual_kd: float = limit(0.3, "1/rad over 20 ms", "the same: to 170 rad/s")
    slow_ki: float = limit(
        30.0,
        "V/(rad s)",
        "a smaller Ki is searched as it is, a larger one by its logarithm",
    )
    ku_beyond: float = limit(2.0, "times the supply", "Ku may be this: full voltage then comes before full height")
    least_ku_v: float = limit(3.0, "V", "enough for friction: a Ku of 0 would do nothing")


@dataclass(frozen=True)
class CostLimits:
    """The cost of a controller's error, beside what is possible (`search/objective.py`)."""

    rms_weight: float = limit(6.0, "", "of the root of the mean square beside the mean size")
    rattle_weight: float = limit(
        9.0, "", "of rattling, as an error: with less, a roll rattled more than before", MEASURED_IN_SEARCHES
    )
    louder_weight: float = limit(3.0, "times rattle_weight", "of what is beyond the rattling from before")
    unheard_rad: float = limit(1e-3, "rad", "less rattling is never louder: four steps of a board's angle")
    chatter_weight: float = limit(0.3, "", "of the chatter that a moving gear bears at most")
    shaking_weight: float = limit(1.0, "", "of the rattling at which the margin while moving is lost")
    bearable_share: float = limit(
        0.7, "of the limit", "chatter and shaking cost from this share of their limits on", MEASURED_IN_SEARCHES
    )
    effort_weight: float = limit(0.02, "", "of the voltage's mean size as a share of the supply")
    worst_plant_share: float = limit(0.5, "", "the worst plant counts so much, the mean of all the rest")
    lost_cost: float = limit(1e3, "", "of a motion that left the range of numbers", BY_DEFINITION)
    least_room_share: float = limit(
        0.1,
        "of the floor",
        "least room between the least error and that before: it divides",
    )
    least_room_rad: float = limit(0.004, "rad", "that room is never less than this")
