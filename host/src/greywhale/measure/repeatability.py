"""The exactness with which an arm comes back to a pose: the figures of ISO 9283 from a log that visits poses.

A visit is a rest of the leader, all joints at once; it counts for the joints of the follower that rest too, and for the
tip if all do. Visits of one pose are told apart by the side from which the leader brought each joint. What counts is
the follower less the leader, so a hand that leads may miss the pose a little. The figures, of the visits from one side
alone (unidirectional):

- AP, accuracy: the distance from the leader to the mean of the places attained.
- RP, repeatability: of an angle 3 S, S its standard deviation; of the tip the mean distance from their mean plus
  3 standard deviations of that distance.
- vAP, multidirectional variation: the largest distance between the means from two sides. It is the lost motion.

The follower's potentiometers say where it is: what lies between them and the joint, they do not see.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TypedDict

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.tip import tip_of
from greywhale.base.errors import UserError
from greywhale.base.types import Flags, Floats
from greywhale.files.log import Log
from greywhale.files.log.driven import following_rows
from greywhale.measure.limits import REPEATABILITY_LIMITS, RepeatabilityLimits
from greywhale.measure.runs import REST_RAD, REST_S, gap_free_runs, resting, stretches
from greywhale.protocol.joints import Joints

SIDES = {-1: "below", 0: "rest", 1: "above"}
SPREAD = 3.0  # standard deviations, in both forms of RP


class ApproachFacts(TypedDict):
    sides: list[str]  # below, above or rest: from where the joint came, or each joint in use
    visits: int
    mean: list[float]  # where it came to, less where it was led: rad of a joint, m of the tip
    accuracy: float  # AP, in the same unit
    repeatability: float  # RP


class PlaceFacts(TypedDict):
    approaches: list[ApproachFacts]
    variation: float | None  # vAP; null: it came from one side alone


class PoseFacts(TypedDict):
    angles_rad: list[float]  # of the leader
    joints: dict[str, PlaceFacts]  # by the joint's number, rad
    tip: PlaceFacts | None  # m; null without an arm file


class RepeatabilityFacts(TypedDict):
    poses: list[PoseFacts]
    unsettled: dict[str, int]  # by the joint's number: visits left out, in which it still moved


@dataclass(frozen=True)
class Approach:
    """The visits of a pose from one side: deviations (visits, dimensions) of the place attained from the one led to."""

    sides: tuple[int, ...]
    deviations: Floats

    @property
    def mean(self) -> Floats:
        mean: Floats = self.deviations.mean(axis=0)
        return mean

    @property
    def accuracy(self) -> float:
        return float(np.linalg.norm(self.mean))

    @property
    def repeatability(self) -> float:
        apart = self.deviations - self.mean
        if apart.shape[1] == 1:
            return SPREAD * float(np.std(apart, ddof=1))
        distances = np.linalg.norm(apart, axis=1)
        return float(distances.mean() + SPREAD * distances.std(ddof=1))

    def as_dict(self) -> ApproachFacts:
        return {
            "sides": [SIDES[side] for side in self.sides],
            "visits": len(self.deviations),
            "mean": self.mean.tolist(),
            "accuracy": self.accuracy,
            "repeatability": self.repeatability,
        }


@dataclass(frozen=True)
class Place:
    """A joint, or the tip, in one pose."""

    approaches: tuple[Approach, ...]

    @property
    def variation(self) -> float | None:
        pairs = combinations(self.approaches, 2)
        return max((float(np.linalg.norm(one.mean - other.mean)) for one, other in pairs), default=None)

    def as_dict(self) -> PlaceFacts:
        return {"approaches": [one.as_dict() for one in self.approaches], "variation": self.variation}

    def moved_from(self, other: Place) -> float | None:
        """The largest distance between the means of both, from the same side each."""
        known = {one.sides: one.mean for one in other.approaches}
        both = [one for one in self.approaches if one.sides in known]
        return max((float(np.linalg.norm(one.mean - known[one.sides])) for one in both), default=None)


@dataclass(frozen=True)
class Pose:
    angles: Floats  # (4,) rad, of the leader
    joints: Mapping[int, Place]
    tip: Place | None

    def places(self) -> Iterator[tuple[int | None, Place]]:
        """Of each joint, and of the tip, whose number is None."""
        yield from self.joints.items()
        if self.tip is not None:
            yield None, self.tip

    def as_dict(self) -> PoseFacts:
        return {
            "angles_rad": self.angles.tolist(),
            "joints": {str(joint): place.as_dict() for joint, place in self.joints.items()},
            "tip": None if self.tip is None else self.tip.as_dict(),
        }


@dataclass(frozen=True)
class Worst:
    """The largest figures of a joint, or of the tip, over all poses and sides: rad, m; None where it has none."""

    visits: int  # the fewest from a side
    accuracy: float
    repeatability: float
    variation: float | None


@dataclass(frozen=True)
class Repeatability:
    """The poses that were visited again, and how many visits each joint did not come to rest in, which do not count."""

    poses: tuple[Pose, ...]
    unsettled: Mapping[int, int]

    def worst(self) -> dict[int | None, Worst]:
        """By the joint, in their order; None: of the tip."""
        found: dict[int | None, list[Place]] = {}
        for pose in self.poses:
            for number, place in pose.places():
                found.setdefault(number, []).append(place)
        joints = sorted(number for number in found if number is not None)
        return {number: _worst(found[number]) for number in [*joints, *([None] if None in found else [])]}

    def moved_from(self, other: Repeatability, limits: RepeatabilityLimits) -> dict[int | None, float]:
        """The farthest that the means of a joint, or of the tip, lie apart in two logs, in a pose that both visit."""
        found: dict[int | None, float] = {}
        for pose in self.poses:
            for same in (one for one in other.poses if _is_same(one.angles, pose.angles, limits)):
                there = dict(same.places())
                for number, place in pose.places():
                    moved = place.moved_from(there[number]) if number in there else None
                    if moved is not None:
                        found[number] = max(moved, found.get(number, 0.0))
        return found

    def as_dict(self) -> RepeatabilityFacts:
        unsettled = {str(joint): count for joint, count in self.unsettled.items()}
        return {"poses": [pose.as_dict() for pose in self.poses], "unsettled": unsettled}


@dataclass(frozen=True)
class _Visit:
    leader: Floats  # (4,) rad
    follower: Floats
    sides: tuple[int, ...]
    settled: Flags  # the joints that came to rest


def repeatability(
    log: Log, arm: ArmParameters | None = None, limits: RepeatabilityLimits = REPEATABILITY_LIMITS
) -> Repeatability:
    """Measure a log; `arm` tells where the tip is."""
    visits = list(_find_visits(log, limits))
    groups: list[list[_Visit]] = []
    for visit in visits:
        known = (one for one in groups if _is_same(one[0].leader, visit.leader, limits))
        group = next(known, None)
        if group is None:
            groups.append([visit])
        else:
            group.append(visit)
    poses = tuple(pose for group in groups for pose in [_pose(group, log.joints_in_use, arm, limits)] if pose.joints)
    if not poses:
        raise UserError(
            f"{log.name}: no joint comes to rest in one pose {limits.least_visits} times from the same side; record "
            "such a log with `greywhale record --poses 30`."
        )
    moving = {joint: sum(not visit.settled[joint] for visit in visits) for joint in log.joints_in_use}
    return Repeatability(poses, {joint: count for joint, count in moving.items() if count})


def _worst(places: Sequence[Place]) -> Worst:
    approaches = [one for place in places for one in place.approaches]
    variations = [place.variation for place in places if place.variation is not None]
    return Worst(
        min(len(one.deviations) for one in approaches),
        max(one.accuracy for one in approaches),
        max(one.repeatability for one in approaches),
        max(variations, default=None),
    )


def _is_same(one: Floats, other: Floats, limits: RepeatabilityLimits) -> bool:
    return bool(np.max(np.abs(one - other)) <= limits.same_pose_rad)


def _find_visits(log: Log, limits: RepeatabilityLimits) -> Iterator[_Visit]:
    """The visits in their order."""
    since, sides = 0, (0,) * log.leader.shape[1]
    for run in gap_free_runs(log.time, following_rows(log), limits.averaged_s):
        window, measured = run.samples(REST_S), run.samples(limits.averaged_s)
        led = log.leader[run.slice]
        rests = np.all([resting(led[:, joint], window, REST_RAD) for joint in log.joints_in_use], axis=0)
        for begin, end in stretches(rests):
            first = run.start + begin - window
            leaves = first + _calm_rows(log.leader[first : run.start + end], limits)
            last = slice(max(first, leaves - measured), leaves)
            pose, follower = log.leader[last].mean(axis=0), log.follower[last]
            way = log.leader[since : last.stop] - pose  # over a gap, too
            sides = tuple(_side(way[:, joint], before, limits) for joint, before in enumerate(sides))
            since = last.stop
            settled = np.ptp(follower, axis=0) <= limits.still_rad
            yield _Visit(pose, follower.mean(axis=0), sides, settled)


def _calm_rows(led: Floats, limits: RepeatabilityLimits) -> int:
    """The rows of a rest before its leader begins to leave: far from its middle, beside its usual tremor."""
    off = np.abs(led - np.median(led, axis=0))
    calm = np.maximum(limits.calm_spreads * np.median(off, axis=0), limits.calm_rad)
    return int(np.flatnonzero((off <= calm).all(axis=1))[-1]) + 1


def _side(way: Floats, before: int, limits: RepeatabilityLimits) -> int:
    """The side on which the leader last was clear of its pose, -1 below, 1 above; of one that never was, that before,
    0 from the beginning.
    """
    clear = np.flatnonzero(np.abs(way) > limits.approach_rad)
    return int(np.sign(way[clear[-1]])) if clear.size else before


def _pose(group: Sequence[_Visit], joints: Joints, arm: ArmParameters | None, limits: RepeatabilityLimits) -> Pose:
    leader, follower, settled = (
        np.array([getattr(one, name) for one in group]) for name in ("leader", "follower", "settled")
    )
    places = {
        joint: _place(
            [(one.sides[joint],) for one in group], (follower - leader)[:, [joint]], settled[:, joint], limits
        )
        for joint in joints
    }
    tip = Place(())
    if arm is not None:
        sides = [tuple(one.sides[joint] for joint in joints) for one in group]
        apart = tip_of(arm, follower) - tip_of(arm, leader)
        all_settled = np.array([bool(one.settled[list(joints)].all()) for one in group])
        tip = _place(sides, apart, all_settled, limits)
    return Pose(
        leader.mean(axis=0),
        {joint: place for joint, place in places.items() if place.approaches},
        tip if tip.approaches else None,
    )


def _place(sides: Sequence[tuple[int, ...]], deviations: Floats, settled: Flags, limits: RepeatabilityLimits) -> Place:
    approaches = [Approach(side, deviations[settled & [one == side for one in sides]]) for side in sorted(set(sides))]
    return Place(tuple(one for one in approaches if len(one.deviations) >= limits.least_visits))


def hidden_play(arm: ArmParameters, poses: Iterable[Floats]) -> tuple[dict[int, float], float]:
    """Lost motion that the arm file's play between joint and potentiometer hides: of each joint (rad), and the most
    that all together are at the tip in one of the poses (m).
    """
    joints = {joint: 2.0 * arm.follower_pots.joint[joint].play for joint in arm.joints_in_use}
    half = 0.5 * np.array([joints.get(joint, 0.0) for joint in range(len(arm.joint))])
    angles = np.array(list(poses))
    apart = tip_of(arm, angles + half) - tip_of(arm, angles - half)
    return {joint: lost for joint, lost in joints.items() if lost > 0.0}, float(np.linalg.norm(apart, axis=1).max())
