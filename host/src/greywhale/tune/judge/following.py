"""Joints that follow worse than with the controllers from before, by the model: where, and how much."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self, TypedDict

import numpy as np

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.types import Controllers, Flags, Floats
from greywhale.protocol.joints import Joints
from greywhale.tune.judge.held_out import HeldOut
from greywhale.tune.limits import TUNING_LIMITS, FollowingLimits, TuningLimits
from greywhale.tune.search.objective import FollowingErrors, Objective, follow
from greywhale.tune.search.training import TrainingMotion


class WorseFacts(TypedDict):
    joint: int
    motion: str
    times: float  # the mean squared error before


@dataclass(frozen=True)
class Worse:
    """A joint whose mean squared error on a motion is so many `times` that from before."""

    joint: int
    motion: str
    times: float

    @property
    def words(self) -> str:
        return f"joint {self.joint} ({JOINT_NAMES[self.joint]}) on {self.motion}, {self.times:.2g} times the error"

    def as_dict(self) -> WorseFacts:
        return {"joint": self.joint, "motion": self.motion, "times": self.times}


def worse_followers(
    held_out: Sequence[HeldOut],
    drills: Sequence[TrainingMotion],
    plant: Floats,
    before: Controllers,
    after: Controllers,
    joints: Joints,
    threads: int = 0,
    limits: FollowingLimits = TUNING_LIMITS.following,
) -> tuple[Worse, ...]:
    """Compare on all motions, on one plant in the bench's own arithmetic: of each name the worst, joint by joint."""
    pairs = [(one.name, one.mse_before, one.mse_after) for one in held_out]
    both = np.stack([before, after])
    pairs += [(one.name, *one.experiment.run_exact(both, plant, threads=threads).mse) for one in drills]
    found: dict[tuple[int, str], float] = {}
    for name, was, now in pairs:
        for joint in joints:
            if _is_worse(was[joint], now[joint], limits):
                found[joint, name] = max(float(now[joint] / was[joint]), found.get((joint, name), 0.0))
    return tuple(Worse(joint, name, times) for (joint, name), times in sorted(found.items()))


def _is_worse(was: float, now: float, limits: FollowingLimits) -> bool:
    return bool(now > limits.follows_worse * was and np.sqrt(now) > np.sqrt(was) + limits.unseen_rad)


@dataclass(frozen=True)
class FollowingBefore:
    """The controllers from before as a measure: errors (classes, 4) in rad on the estimate, costs (4,) without unrest.

    Beside the classes of training motions stand abrupt moves: nobody trains on these, but a joint whose large moves got
    quicker may overshoot there. A joint that hunts at rest (`hunts`) may follow less closely if that calms it.
    """

    objective: Objective
    abrupt: TrainingMotion
    exact: bool
    error: Floats
    cost: Floats
    hunts: Flags
    judging: TuningLimits = TUNING_LIMITS

    @classmethod
    def of(
        cls,
        objective: Objective,
        abrupt: TrainingMotion,
        start: Controllers,
        hunts: Flags,
        exact: bool,
        judging: TuningLimits = TUNING_LIMITS,
    ) -> Self:
        """Of the controllers `start` (4, 13)."""
        found = objective.follow(start[None], exact)
        empty = cls(objective, abrupt, exact, np.zeros(0), objective.costs_of(found)[0], hunts, judging)
        return replace(empty, error=empty._errors(found, start[None])[0])

    def price(self, found: FollowingErrors, controllers: Controllers) -> Floats:
        """Price candidates (n, 4, 13) for a class of motions that they follow less closely than before: (n, 4)."""
        limits = self.judging.following
        most = self.error + self.judging.cost.least_room_rad
        beyond = np.maximum(self._errors(found, controllers) / most - 1.0, 0.0).max(axis=1)
        prices: Floats = np.where((beyond > 0.0) & ~self.hunts, limits.behind_price + beyond, 0.0)
        return prices

    def outweighs(self, costs: Floats) -> Flags:
        """True where a candidate follows no better than this on the whole, (n, 4); `costs` hold no prices."""
        outweighed: Flags = (costs > self.judging.choice.joint_slack * self.cost) & ~self.hunts
        return outweighed

    def _errors(self, found: FollowingErrors, controllers: Controllers) -> Floats:
        """(n, classes, 4) on the estimate."""
        one = self.objective
        sharp = follow(
            [self.abrupt], one.plants[:1], controllers, exact=self.exact, threads=one.threads, limits=one.limits
        )
        return np.concatenate([found.error[:, 0], sharp.error[:, 0]], axis=1)
