"""The least possible error, what a joint must hold, and which controllers are uploaded together."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.base.limits import BY_DEFINITION, MEASURED_IN_SEARCHES, MEASURED_ON_ARMS, limit


@dataclass(frozen=True)
class FloorLimits:
    """The least error that the supply allows to any controller (`judge/floor.py`)."""

    backlash_rad2: float = limit(1e-4, "rad²", "a lower floor may be mere backlash; for less no brake is tried")
    tellable_rad2: float = limit(1e-6, "rad²", "a lower one no potentiometer could tell")
    tried_settling_s: tuple[float, ...] = limit(
        (0.001, 0.004),
        "s",
        "settling times tried; a finer search finds 0.1 % at most",
        MEASURED_ON_ARMS,
    )
    tried_brakes: tuple[float, ...] = limit(
        (0.85, 0.95, 1.1, 1.25), "of the braking curve", "when it brakes, tried for one joint after the other"
    )
    rest_s: float = limit(0.3, "s", "rest of the leader before a move that bounds the error")
    rest_rad: float = limit(0.004, "rad", "the leader rests within this")
    waiting_rad: float = limit(0.01, "rad", "a follower this close to its leader waits")
    waiting_rad_s: float = limit(0.05, "rad/s", "and is this slow; otherwise a move gives no bound")


@dataclass(frozen=True)
class MarginLimits:
    """Limits of a joint's rest, also on a slightly different arm; and the prices that a search pays beyond them."""

    settle_s: float = limit(1.0, "s", "a rest is judged from here on")
    half_gain: float = limit(0.5, "times", "of the scenario with less loop gain", BY_DEFINITION)
    twice_gain: float = limit(2.0, "times", "of the scenario with more loop gain", BY_DEFINITION)
    teeth_stiffness_divisor: float = limit(4.0, "times", "softer teeth have so much less stiffness")
    teeth_damping_divisor: float = limit(8.0, "times", "softer teeth have so much less damping")
    stop_shares: tuple[float, ...] = limit((0.8, -0.2), "of the reach", "where the leader stops, with all joints")
    first_s: float = limit(0.2, "s", "the leader rests this long before its first move")
    rest_s: float = limit(2.2, "s", "a rest in the first search")
    long_rest_s: float = limit(4.0, "s", "a later rest: an integral swings slowly", MEASURED_IN_SEARCHES)
    search_beyond: float = limit(1.15, "times", "gains of a search are further off")
    search_ripple_share: float = limit(0.9, "of the limit", "a search already pays for this much ripple")
    travel_price: float = limit(0.5, "of what is possible", "for each rad/s of swinging in a limit cycle")
    fail_price: float = limit(0.15, "of what is possible", "for a scenario that fails")
    teeth_price: float = limit(
        0.08,
        "of what is possible",
        "for a failure with softer teeth, which recordings hardly show",
    )
    ripple_price: float = limit(0.05, "of what is possible", "for as much ripple at rest as is allowed")
    loud_price: float = limit(1.0, "of what is possible", "the same for what is beyond that")
    lost_price: float = limit(10.0, "of what is possible", "for leaving the range of numbers", BY_DEFINITION)


@dataclass(frozen=True)
class ChoiceLimits:
    """Limits of the controllers that are uploaded together."""

    joint_slack: float = limit(
        1.01,
        "times the cost before",
        "no joint may lose more: it feels its neighbours' new moves a little",
    )
    kept_joint_slack: float = limit(
        1.05,
        "times the cost before",
        "a joint that keeps its controller may lose so much",
        MEASURED_IN_SEARCHES,
    )
    second_chances: int = limit(3, "candidates", "others for a joint that fails, the best first")
    gain_reductions: tuple[tuple[float, float], ...] = limit(
        (
            *((1.0, ki) for ki in (0.5, 0.2, 0.0)),
            *((0.85, ki) for ki in (0.85, 0.5)),
            *((0.7, ki) for ki in (0.7, 0.3, 0.0)),
            *((0.5, ki) for ki in (0.3, 0.0)),
            (0.35, 0.0),
        ),
        "of the best's Ku and Ki",
        "these compete too: gears and integrals may be less quiet than in the search",
        MEASURED_IN_SEARCHES,
    )
    unfit_cost: float = limit(100.0, "", "of a joint that falls short: more than any controller costs", BY_DEFINITION)
    unrest_weight_on_arm: float = limit(
        0.1,
        "",
        "of unrest if the arm itself will judge",
    )
    same_ripple: float = limit(1.05, "times", "one controller's ripple differs so much from one noise to another")
    shaken_ripple: float = limit(1.25, "times", "the same where quicker neighbours shake a joint", MEASURED_IN_SEARCHES)
    worse_in_report: float = limit(1.02, "times the error before", "the report calls an error worse from here on")


@dataclass(frozen=True)
class FollowingLimits:
    """The following of a joint beside that of before (`judge/following.py`)."""

    behind_price: float = limit(
        0.1,
        "of what is possible",
        "for a class of motions that a changed joint follows worse, unless it hunted at rest; plus what is beyond",
    )
    abrupt_s: float = limit(0.01, "s", "edge of abrupt moves: a quick hand")
    follows_worse: float = limit(
        1.05, "times the mean squared error before", "a person is told and, before an upload, asked"
    )
    unseen_rad: float = limit(1e-3, "rad rms", "if the error grew by this too: a fifth of a potentiometer's step")
