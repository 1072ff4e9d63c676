"""Motions on which nothing was tuned: the paper's steps and multi-steps, and a human-like motion of another seed.

The measures run from the moment the motors go on, as a log's do: WAIT_S of soft start and rest, then the motion.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, TypedDict

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.types import Controllers, Floats, PerJoint
from greywhale.files.log import Log
from greywhale.files.log.layout import Origin
from greywhale.files.trajectory import Trajectory
from greywhale.loop import Experiment, human_reaches, multi_steps, steps
from greywhale.loop.closed_loop import shown_angles
from greywhale.measure import Evaluation, evaluate
from greywhale.measure.evaluate import EvaluationFacts
from greywhale.protocol.firmware import TICK_S
from greywhale.protocol.joints import Joints
from greywhale.protocol.table import ParameterTable
from greywhale.tune.judge.floor import Floor, saturation_floor
from greywhale.tune.limits import TUNING_LIMITS, TuningLimits
from greywhale.tune.search.training import clip_motion, fit_motion, reach

WAIT_S = 1.5  # before a motion is judged
SEED = 2001  # of reaches that are played nowhere else
EVERY = 2  # ticks between the rows of the traces


class HeldOutFacts(TypedDict):
    motion: str
    floor_mse_rad2: PerJoint[float] | None  # the least possible error
    floor_bound_mse_rad2: PerJoint[float] | None  # what no controller can be below
    after_as_multiple_of_floor: Annotated[list[float | None], ("minItems", 5), ("maxItems", 5)]  # joints, and in total
    before: EvaluationFacts
    after: EvaluationFacts


@dataclass(frozen=True)
class HeldOut:
    """One motion on which nothing was tuned, in the bench's own arithmetic, on the estimated plant, with sensor noise.

    `floor` is the least error that any controller could reach at that supply, None where it was not computed.
    """

    name: str
    motion: Trajectory = field(repr=False)
    before: Evaluation
    after: Evaluation
    floor: Floor | None
    time_s: Floats = field(repr=False)  # (rows,) from the moment the motors go on
    leader: Floats = field(repr=False)  # (rows, 4) rad
    angles_before: Floats = field(repr=False)  # (rows, 4) rad
    angles_after: Floats = field(repr=False)  # (rows, 4) rad

    @property
    def mse_before(self) -> Floats:
        return np.array([joint.mse for joint in self.before.joints])

    @property
    def mse_after(self) -> Floats:
        return np.array([joint.mse for joint in self.after.joints])

    @property
    def multiples(self) -> tuple[float | None, ...]:
        """The error after tuning as a multiple of the floor, of each joint and all; None where it means nothing."""
        return (None,) * (len(self.mse_after) + 1) if self.floor is None else self.floor.multiple(self.mse_after)

    def as_dict(self) -> HeldOutFacts:
        return {
            "motion": self.name,
            "floor_mse_rad2": None if self.floor is None else self.floor.mse.tolist(),
            "floor_bound_mse_rad2": None if self.floor is None else self.floor.bound.tolist(),
            "after_as_multiple_of_floor": list(self.multiples),
            "before": self.before.as_dict(),
            "after": self.after.as_dict(),
        }


def motions(low: Floats, high: Floats) -> dict[str, Trajectory]:
    """Steps, multi-steps and reaches by name, within the range of the joints."""
    return {
        "steps": clip_motion(steps(), low, high),
        "multi-steps": clip_motion(multi_steps(), low, high),
        "human-like reaches": fit_motion(human_reaches(SEED, 20.0), low, high),
    }


def judge_held_out(
    arm: ArmParameters,
    table: ParameterTable,
    plant: Floats,
    before: Controllers,
    after: Controllers,
    threads: int = 0,
    judging: TuningLimits = TUNING_LIMITS,
) -> tuple[HeldOut, ...]:
    """Evaluate both controllers (4, 13) on one plant (columns,), in the bench's own arithmetic, with sensor noise."""
    judged = []
    for name, motion in motions(*reach(arm, table, plant[None], judging.training)).items():
        experiment = Experiment(motion, arm, table=table, seed=7, wait_s=WAIT_S)
        result = experiment.run_exact(np.stack([before, after]), plant, every=EVERY, threads=threads)
        leader = experiment.leader[::EVERY]
        angles = shown_angles(result.angles, np.repeat(plant[None], 2, axis=0), EVERY * TICK_S)
        floor = None
        if judging.floors:
            led = experiment.lines.motion(motion)
            floor = saturation_floor(led, plant, wait_s=WAIT_S, threads=threads, limits=judging.floor)
        judged.append(
            HeldOut(
                name=name,
                motion=motion,
                before=_evaluate(name, result.time_s, leader, angles[0], arm.joints_in_use),
                after=_evaluate(name, result.time_s, leader, angles[1], arm.joints_in_use),
                floor=floor,
                time_s=result.time_s,
                leader=leader,
                angles_before=angles[0],
                angles_after=angles[1],
            )
        )
    return tuple(judged)


def _evaluate(name: str, time_s: Floats, leader: Floats, follower: Floats, joints: Joints) -> Evaluation:
    state = np.full(len(time_s), "following")
    return evaluate(Log(name, Origin(joints=joints), time_s, leader, follower, np.zeros_like(leader), state, 0, True))
