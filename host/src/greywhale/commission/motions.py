"""The motions of a commissioning: a little first one, and a check in five parts, the small moves first.

No tuning knows the check. Each set of controllers is led along the same one, point by point, so that errors compare.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from greywhale.base.types import Floats
from greywhale.commission.limits import COMMISSIONING_LIMITS, MotionLimits
from greywhale.files.trajectory import Trajectory
from greywhale.loop import human_reaches
from greywhale.loop.leader_motions import EDGE_S, RANGE_RAD, RATE_HZ, minimum_jerk, move_through
from greywhale.protocol.firmware import FASTEST_LED_RAD_S, JOINTS

REACHES_SEED = 3281  # in these each joint goes far; they judge nothing anywhere else
PARTS = ("small moves", "moves", "reaches", "slow motion", "holding still")


@dataclass(frozen=True)
class JointRange:
    """The arm's place and the room of each joint: `pose`, `low` and `high` (4,) in rad."""

    pose: Floats
    low: Floats
    high: Floats

    def place(self, shares: Floats) -> Floats:
        """Angles for shares from -1 (low) over 0 (pose) to 1 (high)."""
        up, down = self.high - self.pose, self.pose - self.low
        return self.pose + np.where(shares > 0.0, up, down) * shares


@dataclass(frozen=True)
class Check:
    """The check, and where its parts begin and end in it: pairs of s by name."""

    motion: Trajectory
    parts: dict[str, tuple[float, float]]


def first_motion(room: JointRange, size: float, limits: MotionLimits = COMMISSIONING_LIMITS.motion) -> Trajectory:
    """Every joint goes `size` rad to the side with more room, slowly, and back."""
    side = np.where(room.high - room.pose >= room.pose - room.low, 1.0, -1.0)
    reach = np.minimum(size, np.where(side > 0.0, room.high - room.pose, room.pose - room.low))
    stops = [room.pose, room.pose + side * reach, room.pose]
    return _through(stops, [limits.first_hold_s] * len(stops), limits.first_edge_s, limits)


def check_motion(room: JointRange, limits: MotionLimits = COMMISSIONING_LIMITS.motion) -> Check:
    """Small moves, moves through the room, human-like reaches, slow motion, and moves of every second joint while the
    others hold still; at rest at the pose between the parts.
    """
    small = [room.pose, *(_within(room, room.pose + size) for size in limits.small_rad)]
    turns = (_turned(number, limits.move_shares) for number in range(len(limits.move_shares)))
    moves = [room.pose, *(room.place(shares) for shares in turns), room.pose]
    hold, pause = limits.hold_s, limits.pause_s
    still_holds = [0.1] + [limits.still_s] * (2 * len(limits.still_shares) - 1) + [pause]
    pieces = (
        _through(small, [pause] + [hold] * len(limits.small_rad), EDGE_S, limits),
        _through(moves, [0.1] + [hold] * (len(moves) - 2) + [limits.rest_s], EDGE_S, limits),
        _reaches(room, limits),
        _slow(room, limits),
        _through(_still(room, limits.still_shares), still_holds, limits.still_s, limits),
    )
    time_s, angles = [pieces[0].time_s[:1]], [pieces[0].angles[:1]]
    parts: dict[str, tuple[float, float]] = {}
    for name, piece in zip(PARTS, pieces, strict=True):
        begin = float(time_s[-1][-1])
        time_s.append(begin + piece.time_s[1:])
        angles.append(piece.angles[1:])
        parts[name] = (begin, float(time_s[-1][-1]))
    return Check(Trajectory(np.concatenate(time_s), np.vstack(angles)), parts)


def _turned(number: int, move_shares: Sequence[float]) -> Floats:
    """The share of every joint at a step; joints 1 and 3 go the other way."""
    shares = [move_shares[(number + joint) % len(move_shares)] for joint in range(JOINTS)]
    return np.array([-share if joint % 2 else share for joint, share in enumerate(shares)])


def _still(room: JointRange, still_shares: Sequence[float]) -> list[Floats]:
    """The pose, then moves of joints 0 and 2 while 1 and 3 hold still, then the other way round."""
    turns = [np.array([share, 0.0, share, 0.0]) for share in still_shares]
    turns += [np.array([0.0, share, 0.0, share]) for share in still_shares]
    return [room.pose, *(room.place(shares) for shares in turns)]


def _within(room: JointRange, angles: Floats) -> Floats:
    """A small move goes to the other side where this side has no room."""
    beyond = (angles > room.high) | (angles < room.low)
    return np.clip(np.where(beyond, 2.0 * room.pose - angles, angles), room.low, room.high)


def _through(stops: list[Floats], holds: list[float], edge_s: float, limits: MotionLimits) -> Trajectory:
    """From stop to stop, each held for its time; an edge takes `edge_s`, or longer where it would be too quick."""
    return move_through(stops, holds, edge_s, limits.speed_share * FASTEST_LED_RAD_S)


def _reaches(room: JointRange, limits: MotionLimits) -> Trajectory:
    """Human-like reaches, scaled into the room; from the pose and back to it."""
    human = human_reaches(REACHES_SEED, limits.reaches_s)
    middle, half = RANGE_RAD.mean(axis=1), 0.5 * (RANGE_RAD[:, 1] - RANGE_RAD[:, 0])
    shares = limits.reaches_share * np.clip((human.angles - middle) / half, -1.0, 1.0)
    return _back(Trajectory(human.time_s, room.place(shares)), room.pose, limits)


def _slow(room: JointRange, limits: MotionLimits) -> Trajectory:
    """One slow swing to both sides, in which a joint rattles most easily."""
    time_s = np.arange(round(limits.slow_s * RATE_HZ) + 1) / RATE_HZ
    turn = 2.0 * np.pi * time_s / limits.slow_s
    swing = limits.slow_share * np.sin(turn) * minimum_jerk(time_s / 1.0)
    sides = np.array([1.0, -1.0, 1.0, -1.0])
    angles = np.array([room.place(share * sides) for share in swing])
    return Trajectory(np.append(time_s, limits.slow_s + limits.pause_s), np.vstack([angles, room.pose]))


def _back(motion: Trajectory, pose: Floats, limits: MotionLimits) -> Trajectory:
    """The motion, then the way to the pose, and a rest there."""
    way = _through([motion.angles[-1], pose], [0.05, limits.pause_s], 0.5, limits)
    times = np.concatenate([motion.time_s, motion.duration_s + way.time_s[1:]])
    return Trajectory(times, np.vstack([motion.angles, way.angles[1:]]))
