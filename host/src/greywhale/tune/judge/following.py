"""Joints that follow worse than with the controllers from before, by the model: where, and how much."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
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
class ErrorsBefore:
    """The errors (classes, 4) of the controllers from before on the estimate, which a changed joint may not exceed.

    A joint that hunts there at rest (`hunts`) may follow less closely if that calms it.
    """

    error: Floats
    hunts: Flags
    judging: TuningLimits = TUNING_LIMITS

    @classmethod
    def of(cls, objective: Objective, start: Controllers, hunts: Flags, exact: bool = False) -> Self:
        """Of the controllers `start` (4, 13), on the plant that an objective names first."""
        found = follow(objective.drills, objective.plants[:1], start[None], exact=exact, threads=objective.threads)
        return cls(found.error[0, 0], hunts)

    def excess(self, found: FollowingErrors) -> Floats:
        """By how much a joint of a candidate follows some class of motions worse, as a share of the error, (n, 4)."""
        most = self.judging.following.error_slack * self.error + self.judging.cost.least_room_rad
        beyond: Floats = np.maximum(found.error[:, 0] / most - 1.0, 0.0).max(axis=1)
        return np.where(self.hunts, 0.0, beyond)
