"""The cost of a candidate, slowly in numpy, by the formulas of tune.search.objective: host/native/score must agree."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from greywhale.base.types import Flags, Floats, Integers
from greywhale.loop import Result
from greywhale.measure.swings import Hunting, count_swings
from greywhale.protocol.firmware import JOINTS, TICK_S
from greywhale.protocol.schema import Board
from greywhale.tune.judge.margins import AT_REST, TEETH
from greywhale.tune.judge.standard import Counts
from greywhale.tune.limits import TUNING_LIMITS
from greywhale.tune.search.objective import ErrorScale, FollowingErrors
from tests.support.swings import chatter, duty_swings, rattle, ripple

COST, SWINGS, MARGINS, CHOICE = (getattr(TUNING_LIMITS, name) for name in ("cost", "swings", "margins", "choice"))


# --- following --------------------------------------------------------------------------------------------------------


def error_of(weighted: Floats, square: Floats) -> Floats:
    return np.asarray(weighted + COST.rms_weight * np.sqrt(square))


def room_of(error_before: Floats, floor: Floats) -> Floats:
    return np.asarray(np.maximum(error_before - floor, np.maximum(COST.least_room_share * floor, COST.least_room_rad)))


def follow(result: Result, leader: Floats, total_weight: float, wait_s: float, board: Board) -> Sequence[Floats]:
    """Error, volts, rattling and chatter (n, 4) of one motion."""
    error = error_of(result.itae / total_weight, result.mse)
    error[result.diverged] = COST.lost_cost
    shaken = rattle(result.angles, leader, 1, wait_s)
    shaken[result.diverged] = COST.lost_cost
    return error, result.itau / total_weight, shaken, chatter(result.duties, 1, board)


def relative_costs(found: FollowingErrors, scale: ErrorScale, supply_v: float) -> Floats:
    """The cost of every class: (n, plants, classes, 4)."""
    louder = np.maximum(found.rattle - np.maximum(scale.rattle, COST.unheard_rad), 0.0)
    avoidable = np.maximum(found.error - scale.floor, 0.0)
    length = avoidable + COST.rattle_weight * (found.rattle + COST.louder_weight * louder)
    unbearable = np.maximum(found.chatter / SWINGS.chatter_moving_hz - COST.bearable_share, 0.0)
    shaking = np.maximum(found.rattle / SWINGS.rattle_moving_rad - COST.bearable_share, 0.0)
    share = length / scale.room + COST.chatter_weight * unbearable + COST.shaking_weight * shaking
    return np.asarray(np.sqrt(share + COST.effort_weight * found.volts / supply_v))


def total_costs(relative: Floats, importances: Sequence[float]) -> Floats:
    weights = np.array(importances)
    each = (weights[:, None] * relative).sum(axis=2) / weights.sum()
    worst = COST.worst_plant_share
    return np.asarray((1.0 - worst) * each.mean(axis=1) + worst * each.max(axis=1))


# --- rest -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Unrest:
    """In the worst rest of the record, the ripple in all of them: (n, 4) each, or (n, plants, 4)."""

    reversals: Integers
    travel: Floats
    chatter: Floats
    ripple: Floats
    fails: Flags
    lost: Flags


def unrest(result: Result, rests: Sequence[tuple[int, int]], cycle: Hunting, supply_v: float, board: Board) -> Unrest:
    reversals = np.zeros((len(result.mse), JOINTS), dtype=np.int32)
    travel, beats, squares = (np.zeros(reversals.shape) for _ in range(3))
    for rows in rests:
        seconds = (rows[1] - rows[0]) * TICK_S
        turned, moved = count_swings(result.angles, *rows, cycle.band_rad)
        reversals = np.maximum(reversals, turned)
        travel = np.maximum(travel, np.where(turned >= cycle.turns, moved / seconds, 0.0))
        beats = np.maximum(beats, duty_swings(result.duties, rows, board) / seconds)
        squares += (rows[1] - rows[0]) * (supply_v * ripple(result.duties, rows, board)) ** 2
    loud = np.sqrt(squares / sum(last - first for first, last in rests))
    lost = np.repeat(result.diverged[:, None], JOINTS, axis=1)
    fails = (reversals >= cycle.turns) | (beats > SWINGS.chatter_at_rest_hz) | lost
    return Unrest(reversals, travel, beats, loud, fails, lost)


def penalty(found: Mapping[str, Unrest], quiet_v: Floats) -> Floats:
    """Prices (n, 4) of candidates on some plants."""
    share = found[AT_REST].ripple.mean(axis=1) / quiet_v
    beyond = np.maximum(share - MARGINS.search_ripple_share, 0.0)
    total = MARGINS.ripple_price * share + MARGINS.loud_price * beyond
    for scenario, one in found.items():
        fails = (MARGINS.teeth_price if scenario == TEETH else MARGINS.fail_price) * one.fails
        total = total + (MARGINS.travel_price * one.travel + fails + MARGINS.lost_price * one.lost).mean(axis=1)
    return np.asarray(total)


def falls_short(found: Mapping[str, Unrest], failing: Mapping[str, Counts], quiet_v: Floats, kept: Flags) -> Flags:
    most = np.where(kept, CHOICE.shaken_ripple, CHOICE.same_ripple)
    short: Flags = found[AT_REST].ripple.max(axis=1) > most * quiet_v
    for scenario, one in found.items():
        if scenario != TEETH:
            short = short | (one.fails.sum(axis=1) > failing[scenario])
    return short
