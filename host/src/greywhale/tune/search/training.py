"""The motions on which controllers are trained, one a class: moves to both sides, human-like reaches, slow following.

The weight of a moment is SOON_S plus the time since the leader last moved: an error counts while the leader moves, and
counts more the longer the leader has been at rest. The time starts again with every move, so the tenth move of a record
weighs as much as the first. In slow following the leader hardly ever rests, so there all moments weigh the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from greywhale.arm import ArmParameters
from greywhale.arm.plants import column
from greywhale.base.errors import BadUsage
from greywhale.base.types import Floats
from greywhale.files.trajectory import Trajectory
from greywhale.loop import Experiment, human_reaches
from greywhale.loop.leader_motions import minimum_jerk
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import ParameterTable

RATE_HZ = 200.0
EDGE_S = 0.04  # a hand cannot jump; as in trajectory.multi_steps
# Levels of the moves (shares of the reach), rotated from joint to joint: sizes from 0.1 to 1, as many up as down.
LEVELS = (0.0, 1.0, 0.9, 0.4, -0.6, -0.5, 0.0, -1.0, 0.0)
HOLD_S = 1.2
REACH_RAD = 1.0
# This distance to limits and stops is kept (rad).
CLEAR_RAD = 0.15
# A joint's range must have at least this much left (rad).
LEAST_RANGE_RAD = 0.2
# Reaches in which every joint moves far: where one hardly moves, its cost is mostly noise and rattling. They judge
# nothing anywhere else.
HUMAN_SEED = 1006
HUMAN_S = 9.0
# Slow following: waves of these periods (s), in shares of a size that is small beside the moves.
SLOW_S = 8.0
SLOW_PERIODS_S = (2.3, 4.1)
SLOW_SHARES = (0.4, 0.6)
SLOW_RAD = 0.15
SLOW = "slow following"
# Every joint rests in its own part of the record while the others go on; it stops and starts within this time.
EASE_S = 0.4
WAIT_S = 0.2
SOON_S = 0.1
# The leader counts as moving while it changes by this much (rad) within this time (s); a hand's tremor is far smaller.
MOVING_RAD, MOVING_S = 0.02, 0.1


@dataclass(frozen=True)
class TrainingMotion:
    """One training motion, the only one of its class, with its weights."""

    name: str
    motion: Trajectory
    experiment: Experiment
    total_weight: float  # the integral of the weights
    importance: float  # beside the other classes


def training_motions(
    arm: ArmParameters, table: ParameterTable, plants: Floats, seed: int = 0
) -> tuple[TrainingMotion, ...]:
    """The training motions within the range of this arm and table, with sensor noise."""
    low, high = reach(arm, table, plants)
    large = moves(low, high)
    human = fit_motion(human_reaches(HUMAN_SEED, HUMAN_S), low, high)
    slow = slow_following(low, high)
    classes = {
        "moves to both sides": (large, time_since_move(large, WAIT_S), 2.0),
        "human-like reaches": (human, time_since_move(human, WAIT_S), 1.0),
        SLOW: (slow, np.where(tick_times(slow, WAIT_S) < 0.0, 0.0, 1.0), 1.0),
    }
    return tuple(
        _training_motion(name, *facts, arm, table, noise_seed(seed, number))
        for number, (name, facts) in enumerate(classes.items())
    )


def noise_seed(seed: int, number: int) -> int:
    """The seed of the sensor noise in a class."""
    return 100 * seed + number + 11


def own_motion(
    motion: Trajectory, arm: ArmParameters, table: ParameterTable, plants: Floats, seed: int = 0
) -> TrainingMotion:
    """A motion that a person made, within the range of this arm and table, with sensor noise."""
    clipped = clip_motion(motion, *reach(arm, table, plants))
    weight = time_since_move(clipped, WAIT_S)
    return _training_motion("the person's own", clipped, weight, 1.0, arm, table, noise_seed(seed, 0))


def _training_motion(
    name: str,
    motion: Trajectory,
    weight: Floats,
    importance: float,
    arm: ArmParameters,
    table: ParameterTable,
    seed: int,
) -> TrainingMotion:
    experiment = Experiment(motion, arm, table=table, seed=seed, wait_s=WAIT_S, soft_start=False, weight_s=weight)
    return TrainingMotion(name, motion, experiment, float(weight.sum()) * 1e-3, importance)


def reach(arm: ArmParameters, table: ParameterTable, plants: Floats) -> tuple[Floats, Floats]:
    """The lowest and highest angle (4,) that the table's limits and all plants' stops allow, some distance kept.

    Both are 0 for a joint that is not in use.
    """
    low, high = np.zeros(JOINTS), np.zeros(JOINTS)
    for joint in arm.joints_in_use:
        limits = [table.physical(f"joint{joint}.limit_{side}") for side in ("min", "max")]
        stops = [plants[:, column(f"stop_{side}", joint)] for side in ("min", "max")]
        low[joint] = max(limits[0], float(stops[0].max())) + CLEAR_RAD
        high[joint] = min(limits[1], float(stops[1].min())) - CLEAR_RAD
        if high[joint] - low[joint] < LEAST_RANGE_RAD:
            raise BadUsage(
                f"joint {joint} has no room to move: limits {limits[0]:g} to {limits[1]:g} rad, stops "
                f"{arm.joint[joint].stops.min:g} to {arm.joint[joint].stops.max:g} rad; correct them."
            )
    return low, high


def moves(low: Floats, high: Floats, hold_s: float = HOLD_S) -> Trajectory:
    """All joints move at the same instants. Each goes through the levels in its own order, around its middle or 0."""
    middle, size = centre(low, high)
    count = len(LEVELS)
    edges = hold_s * np.arange(1, count)
    time_s = np.arange(round(hold_s * count * RATE_HZ) + 1) / RATE_HZ
    angles = np.empty((len(time_s), JOINTS))
    for joint in range(JOINTS):
        levels = _levels_of(joint)
        path = np.full(len(time_s), levels[0])
        for edge, a, b in zip(edges, levels[:-1], levels[1:], strict=True):
            path += (b - a) * minimum_jerk((time_s - edge) / EDGE_S)
        angles[:, joint] = middle[joint] + size[joint] * path
    return Trajectory(time_s, angles)


def _levels_of(joint: int) -> list[float]:
    """From rest at 0 through the levels, from another starting level for each joint, mirrored on every second joint."""
    inner = list(LEVELS[1:-1])
    turned = inner[2 * joint % len(inner) :] + inner[: 2 * joint % len(inner)]
    sign = -1.0 if joint % 2 else 1.0
    return [0.0, *(sign * level for level in turned), 0.0]


def slow_following(low: Floats, high: Floats) -> Trajectory:
    """Small slow waves of all joints around their middle or 0. Each rests in one quarter while the others move."""
    middle, size = centre(low, high)
    time_s = np.arange(round(SLOW_S * RATE_HZ) + 1) / RATE_HZ
    part = SLOW_S / JOINTS
    angles = np.empty((len(time_s), JOINTS))
    for joint in range(JOINTS):
        start = part * joint
        # The joint's own clock stands still in its quarter, and goes slowly at both ends of it.
        speed = np.clip(np.maximum(start - time_s, time_s - (start + part)) / EASE_S + 1.0, 0.0, 1.0)
        clock = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))]) / RATE_HZ
        phase = 0.5 * np.pi * joint
        path = sum(
            share * (np.sin(2.0 * np.pi * clock / period + phase) - np.sin(phase))
            for share, period in zip(SLOW_SHARES, SLOW_PERIODS_S, strict=True)
        )
        angles[:, joint] = middle[joint] + min(SLOW_RAD, size[joint]) * path * minimum_jerk(time_s / EASE_S)
    return clip_motion(Trajectory(time_s, angles), low, high)


def centre(low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Where a joint rests and how far it goes to either side: 0 and 1 rad where the range has room for that."""
    size = np.minimum(REACH_RAD, 0.5 * (high - low))
    return np.clip(0.0, low + size, high - size), size


def fit_motion(motion: Trajectory, low: Floats, high: Floats) -> Trajectory:
    """The motion within the range: moved to it, and made smaller where the range is narrower than the motion."""
    least, most = motion.angles.min(axis=0), motion.angles.max(axis=0)
    share = np.minimum(1.0, (high - low) / np.maximum(most - least, 1e-9))
    return Trajectory(motion.time_s, share * motion.angles + np.clip(0.0, low - share * least, high - share * most))


def clip_motion(motion: Trajectory, low: Floats, high: Floats) -> Trajectory:
    """The motion with its angles clipped to the range."""
    return Trajectory(motion.time_s, np.clip(motion.angles, low, high))


def time_since_move(motion: Trajectory, wait_s: float) -> Floats:
    """The weight (s) of every tick of an Experiment that waits `wait_s`; 0 while it waits."""
    time_s, moving = moving_ticks(motion, wait_s)
    last = np.maximum.accumulate(np.where(moving, time_s, 0.0))
    return np.where(time_s < 0.0, 0.0, SOON_S + time_s - last)


def moving_ticks(motion: Trajectory, wait_s: float) -> tuple[Floats, NDArray[np.bool_]]:
    """When every tick of an Experiment that waits `wait_s` is (s), and whether the leader then moves."""
    time_s = tick_times(motion, wait_s)
    change = np.abs(motion.at(time_s) - motion.at(time_s - MOVING_S)).max(axis=1)
    return time_s, change > MOVING_RAD


def tick_times(motion: Trajectory, wait_s: float) -> Floats:
    """When every tick of an Experiment that waits `wait_s` is, s; below 0 while it waits."""
    ticks = int(np.ceil((wait_s + motion.duration_s) / 1e-3 - 1e-9))
    return np.arange(ticks, dtype=np.float64) * 1e-3 - wait_s
