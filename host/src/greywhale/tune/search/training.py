"""The motions on which controllers are trained, one a class: moves to both sides, human-like reaches, slow following.

The weight of a moment is `soon_s` plus the time since the leader last moved: an error counts while the leader moves,
and counts more the longer the leader has been at rest. The time starts again with every move, so the tenth move of a
record weighs as much as the first. In slow following the leader hardly ever rests, so there all moments weigh the same.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from greywhale.arm import ArmParameters
from greywhale.arm.plants import column
from greywhale.base.errors import BadUsage
from greywhale.base.types import Floats
from greywhale.files.trajectory import Trajectory
from greywhale.loop import Experiment, human_reaches
from greywhale.loop.closed_loop import FollowerLines
from greywhale.loop.leader_motions import RATE_HZ, minimum_jerk
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import ParameterTable
from greywhale.tune.limits import TUNING_LIMITS, TrainingLimits

WAIT_S = 0.2  # before a motion begins
HUMAN_SEED = 1006  # of reaches in which every joint moves far: where one hardly moves, its cost is mostly noise
SLOW = "slow following"


@dataclass(frozen=True)
class TrainingMotion:
    """One training motion, the only one of its class, with its weights."""

    name: str
    motion: Trajectory
    experiment: Experiment
    total_weight: float  # the integral of the weights
    importance: float  # beside the other classes


def training_motions(
    arm: ArmParameters,
    table: ParameterTable,
    plants: Floats,
    seed: int = 0,
    limits: TrainingLimits = TUNING_LIMITS.training,
) -> tuple[TrainingMotion, ...]:
    """The training motions within the range of this arm and table, with sensor noise."""
    low, high = reach(arm, table, plants, limits)
    large = moves(low, high, limits)
    human = fit_motion(human_reaches(HUMAN_SEED, limits.human_s), low, high)
    slow = slow_following(low, high, limits)
    classes = {
        "moves to both sides": (large, time_since_move(large, WAIT_S, limits), 2.0),
        "human-like reaches": (human, time_since_move(human, WAIT_S, limits), 1.0),
        SLOW: (slow, np.where(tick_times(slow, WAIT_S) < 0.0, 0.0, 1.0), 1.0),
    }
    return tuple(
        _training_motion(name, *facts, arm, table, noise_seed(seed, number))
        for number, (name, facts) in enumerate(classes.items())
    )


def abrupt_moves(
    arm: ArmParameters, table: ParameterTable, plants: Floats, edge_s: float, seed: int, limits: TrainingLimits
) -> TrainingMotion:
    """Moves to both sides whose edges are sharper than those of the training."""
    motion = moves(*reach(arm, table, plants, limits), replace(limits, edge_s=edge_s))
    weight = time_since_move(motion, WAIT_S, limits)
    return _training_motion("abrupt moves", motion, weight, 1.0, arm, table, noise_seed(seed, 0))


def noise_seed(seed: int, number: int) -> int:
    """The seed of the sensor noise in a class."""
    return 100 * seed + number + 11


def own_motion(
    motion: Trajectory,
    arm: ArmParameters,
    table: ParameterTable,
    plants: Floats,
    seed: int = 0,
    limits: TrainingLimits = TUNING_LIMITS.training,
) -> TrainingMotion:
    """A motion that a person made, within the range of this arm and table, with sensor noise."""
    clipped = clip_motion(motion, *reach(arm, table, plants, limits))
    weight = time_since_move(clipped, WAIT_S, limits)
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


def reach(
    arm: ArmParameters, table: ParameterTable, plants: Floats, limits: TrainingLimits = TUNING_LIMITS.training
) -> tuple[Floats, Floats]:
    """The leader's lowest and highest angle (4,) that the table's limits and all plants' stops allow, at a distance.

    Both are 0 for a joint that is not in use.
    """
    low, high = np.zeros(JOINTS), np.zeros(JOINTS)
    lines = FollowerLines.of(arm, table)
    for joint in arm.joints_in_use:
        ends = [table.physical(f"joint{joint}.limit_{side}") for side in ("min", "max")]
        stops = [lines.leader(plants[:, column(f"stop_{side}", joint)], joint) for side in ("min", "max")]
        low[joint] = max(ends[0], float(stops[0].max())) + limits.clear_rad
        high[joint] = min(ends[1], float(stops[1].min())) - limits.clear_rad
        if high[joint] - low[joint] < limits.least_range_rad:
            raise BadUsage(
                f"joint {joint} has no room to move: limits {ends[0]:g} to {ends[1]:g} rad, stops "
                f"{arm.joint[joint].stops.min:g} to {arm.joint[joint].stops.max:g} rad; correct them."
            )
    return low, high


def moves(low: Floats, high: Floats, limits: TrainingLimits = TUNING_LIMITS.training) -> Trajectory:
    """All joints move at the same instants. Each goes through the levels in its own order, around its middle or 0."""
    middle, size = centre(low, high, limits)
    count, hold_s = len(limits.levels), limits.hold_s
    edges = hold_s * np.arange(1, count)
    time_s = np.arange(round(hold_s * count * RATE_HZ) + 1) / RATE_HZ
    angles = np.empty((len(time_s), JOINTS))
    for joint in range(JOINTS):
        levels = _levels_of(joint, limits)
        path = np.full(len(time_s), levels[0])
        for edge, a, b in zip(edges, levels[:-1], levels[1:], strict=True):
            path += (b - a) * minimum_jerk((time_s - edge) / limits.edge_s)
        angles[:, joint] = middle[joint] + size[joint] * path
    return Trajectory(time_s, angles)


def _levels_of(joint: int, limits: TrainingLimits) -> list[float]:
    """From rest at 0 through the levels, from another starting level for each joint, mirrored on every second joint."""
    inner = list(limits.levels[1:-1])
    turned = inner[2 * joint % len(inner) :] + inner[: 2 * joint % len(inner)]
    sign = -1.0 if joint % 2 else 1.0
    return [0.0, *(sign * level for level in turned), 0.0]


def slow_following(low: Floats, high: Floats, limits: TrainingLimits = TUNING_LIMITS.training) -> Trajectory:
    """Small slow waves of all joints around their middle or 0. Each rests in one quarter while the others move."""
    middle, size = centre(low, high, limits)
    time_s = np.arange(round(limits.slow_s * RATE_HZ) + 1) / RATE_HZ
    part = limits.slow_s / JOINTS
    angles = np.empty((len(time_s), JOINTS))
    for joint in range(JOINTS):
        start = part * joint
        # The joint's own clock stands still in its quarter, and goes slowly at both ends of it.
        speed = np.clip(np.maximum(start - time_s, time_s - (start + part)) / limits.ease_s + 1.0, 0.0, 1.0)
        clock = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))]) / RATE_HZ
        phase = 0.5 * np.pi * joint
        path = sum(
            share * (np.sin(2.0 * np.pi * clock / period + phase) - np.sin(phase))
            for share, period in zip(limits.slow_shares, limits.slow_periods_s, strict=True)
        )
        size_rad = min(limits.slow_rad, size[joint])
        angles[:, joint] = middle[joint] + size_rad * path * minimum_jerk(time_s / limits.ease_s)
    return clip_motion(Trajectory(time_s, angles), low, high)


def centre(low: Floats, high: Floats, limits: TrainingLimits = TUNING_LIMITS.training) -> tuple[Floats, Floats]:
    """Return where a joint rests and how far it goes to either side: 0 and 1 rad where the range has room for that."""
    size = np.minimum(limits.reach_rad, 0.5 * (high - low))
    return np.clip(0.0, low + size, high - size), size


def fit_motion(motion: Trajectory, low: Floats, high: Floats) -> Trajectory:
    """The motion within the range: moved to it, and made smaller where the range is narrower than the motion."""
    least, most = motion.angles.min(axis=0), motion.angles.max(axis=0)
    share = np.minimum(1.0, (high - low) / np.maximum(most - least, 1e-9))
    return Trajectory(motion.time_s, share * motion.angles + np.clip(0.0, low - share * least, high - share * most))


def clip_motion(motion: Trajectory, low: Floats, high: Floats) -> Trajectory:
    """The motion with its angles clipped to the range."""
    return Trajectory(motion.time_s, np.clip(motion.angles, low, high))


def time_since_move(motion: Trajectory, wait_s: float, limits: TrainingLimits = TUNING_LIMITS.training) -> Floats:
    """The weight (s) of every tick of an Experiment that waits `wait_s`; 0 while it waits."""
    time_s, moving = moving_ticks(motion, wait_s, limits)
    last = np.maximum.accumulate(np.where(moving, time_s, 0.0))
    return np.where(time_s < 0.0, 0.0, limits.soon_s + time_s - last)


def moving_ticks(
    motion: Trajectory, wait_s: float, limits: TrainingLimits = TUNING_LIMITS.training
) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the time (s) of every tick of an Experiment that waits `wait_s`, and whether the leader then moves."""
    time_s = tick_times(motion, wait_s)
    change = np.abs(motion.at(time_s) - motion.at(time_s - limits.moving_s)).max(axis=1)
    return time_s, change > limits.moving_rad


def tick_times(motion: Trajectory, wait_s: float) -> Floats:
    """Return the time (s) of every tick of an Experiment that waits `wait_s`; below 0 while it waits."""
    ticks = int(np.ceil((wait_s + motion.duration_s) / 1e-3 - 1e-9))
    return np.arange(ticks, dtype=np.float64) * 1e-3 - wait_s
