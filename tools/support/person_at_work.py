"""A person who works with an arm that changes, on a bench in lock step."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.types import Floats
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.firmware import JOINTS
from greywhale_sim.assemble import BenchOptions, build_bench
from greywhale_sim.bench import SLICE_S, Bench
from greywhale_sim.leader_player import LeaderPlayer
from greywhale_sim.lockstep import LockStepBench
from tools.support.foreign_arm import MuJoCoPlant

# Motors that are off for less than this (s) do not end the work: the person waits where they are.
PATIENCE_S = 0.3
# The arm changes at every so many seconds.
CHANGE_S = 5.0

ArmAt = Callable[[float], ArmParameters]


class PersonAtWork(LeaderPlayer):
    """Goes on with the motion after a short pause of the motors; `at_time` is called with the seconds of work.

    `errors` holds the mean of (leader - follower)², (4,) rad², of every whole second of work.
    """

    def __init__(self, motion: Trajectory, at_time: Callable[[float], None]) -> None:
        super().__init__(motion, SLICE_S)
        self.set_patience(round(PATIENCE_S / SLICE_S))
        self._at_time = at_time
        self._worked = 0
        self._was_at = self.angles
        self.errors: list[Floats] = []
        self._sum: Floats = np.zeros(JOINTS)

    def watch(self, cycle: int, pins: Floats, follower: Floats) -> None:
        """Look at the arms after every slice: the bench's trace."""
        leader, self._was_at = self._was_at, self.angles
        if not pins[0]:
            return
        self._worked += 1
        self._sum = self._sum + (leader - follower) ** 2
        if self._worked % round(1.0 / SLICE_S) == 0:
            self.errors.append(self._sum * SLICE_S)
            self._sum = np.zeros(JOINTS)
        if self._worked % round(CHANGE_S / SLICE_S) == 0:
            self._at_time(self._worked * SLICE_S)


def working_bench(
    motion: Trajectory, arm_at: ArmAt, options: BenchOptions | None = None, plant: MuJoCoPlant | None = None
) -> tuple[LockStepBench, PersonAtWork]:
    """An arm, without options the default one, which becomes what `arm_at` says of the seconds of work, and who works
    with it. Another engine's plant moves it where one is given.
    """
    options = options or BenchOptions()
    person = PersonAtWork(motion, lambda seconds: become(bench, arm_at(seconds)))
    bench = build_bench(options, plant, person)
    bench.trace = person.watch
    return LockStepBench(options, bench), person


def become(bench: Bench, parameters: ArmParameters) -> None:
    """Let the bench's arm have other parameters from now on, where it is; in our engine it begins at rest."""
    plant = bench.plant
    if isinstance(plant, MuJoCoPlant):
        plant.become(parameters)
    else:
        bench.become(parameters)


def grown_friction(arm: ArmParameters, factor: float) -> ArmParameters:
    """A copy of the arm with so many times the dry friction at every joint."""
    joints = []
    for joint in arm.joint:
        more = {name: factor * getattr(joint.friction, name) for name in ("coulomb", "breakaway")}
        joints.append(joint.model_copy(update={"friction": joint.friction.model_copy(update=more)}))
    return arm.model_copy(update={"joint": tuple(joints)})


def stickier(arm: ArmParameters, within_s: float = 120.0, by: float = 0.4) -> ArmAt:
    """An arm whose friction grows evenly."""
    return lambda seconds: grown_friction(arm, 1.0 + by * min(1.0, seconds / within_s))
