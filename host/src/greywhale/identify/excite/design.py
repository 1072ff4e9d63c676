"""Finds the motion that shows most about an arm: the safe multi-sine of greatest information (D-optimal).

The information is that of the follower in the closed loop with the board's own controllers. What is known before counts
too: the covariance of a model.toml, or the doubts of an arm file. So with a model, the search finds a motion for what
the model's logs left open.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from greywhale.arm import ArmParameters
from greywhale.base.errors import UserError, require_between, require_within
from greywhale.base.types import Floats, Progress, show_no_progress
from greywhale.files.trajectory import Trajectory
from greywhale.identify.excite.information import information, natural_sizes, prior
from greywhale.identify.excite.limits import Limits, family, limits_of
from greywhale.identify.excite.multisine import LONGEST_S, SHORTEST_S, Shape
from greywhale.identify.excite.trial import ROW_S, Trial, try_motion
from greywhale.identify.limits import IDENTIFICATION_LIMITS, IdentificationLimits
from greywhale.identify.samples import read_search
from greywhale.identify.space import MOTOR, Parameter, Space
from greywhale.identify.uncertainty import open_beyond
from greywhale.loop import plant_row
from greywhale.optimise import DEFAULT, create
from greywhale.protocol.table import ParameterTable

BUDGET = 300  # unless somebody asks for another
GOOD_BUDGET = 150  # finds a good motion; the last evaluations of a search for the best one would gain little
MOST_BUDGET = 100_000  # takes a day
SECONDS = 20.0  # unless somebody asks for another length
# The quantities that count where an arm file does not say what is known: as in a usual identification.
USUAL = (*MOTOR, "coulomb", "breakaway", "gap", "teeth")
SHRINKS = 30  # of a motion that is not safe on some arm, one after the other


@dataclass(frozen=True)
class Problem:
    """The basis on which a motion is judged: the arm, its family, the parameters and what is known of them."""

    parameters: tuple[Parameter, ...]
    plants: Floats  # (1 + family, columns), that the motion is tried on
    nominal: Floats  # (columns,), whose parameters the information is about
    known: Floats  # information before, (n, n)
    table: ParameterTable
    limits: Limits
    judging: IdentificationLimits = IDENTIFICATION_LIMITS

    @classmethod
    def of(
        cls,
        arm: ArmParameters,
        table: ParameterTable,
        pose: Floats,
        ranges: Mapping[int, tuple[float, float]],
        seed: int,
        judging: IdentificationLimits = IDENTIFICATION_LIMITS,
    ) -> Problem:
        limits = limits_of(arm, table, pose, ranges, judging.excitation)
        if "covariance" in (arm.identification or {}):
            space, _, covariance = read_search(arm)
            nominal, known = plant_row(arm), prior(space.parameters, covariance, space.doubts())
        else:
            space = Space.of(arm, USUAL, arm.joints_in_use)
            nominal, known = space.plants(space.start()[None])[0], np.diag(space.doubts() ** -2.0)
        plants = family(arm, seed, judging.excitation)
        return cls(space.parameters, plants, nominal, known, table, limits, judging)

    def judge(self, angles: Floats) -> Judgement:
        """Judge points (rows, 4) rad, 16 ms apart."""
        tried = try_motion(angles, self.table, self.plants)
        told = information(self.nominal, tried.angles[0], ROW_S, self.parameters, self.judging) + self.known
        size = natural_sizes(self.parameters)
        log_det = float(np.linalg.slogdet(told * np.outer(size, size))[1])
        price = self.judging.excitation.unsafe_price
        return Judgement(log_det, np.sqrt(np.diag(np.linalg.inv(told))), tried, self._excess(tried), price)

    def _excess(self, tried: Trial) -> float:
        """The share by which the worst arm of the family exceeds its allowed lag or range; 0 where none does."""
        beyond = np.maximum(self.limits.low - tried.angles.min(axis=1), tried.angles.max(axis=1) - self.limits.high)
        lag, overshoot = tried.lag.max() / self.limits.lag, beyond.max() / self.judging.excitation.margin_rad
        return max(0.0, float(max(lag, overshoot)) - 1.0)


@dataclass(frozen=True)
class Judgement:
    """`log_det` of the information, parameters in natural sizes; `deviations` (n,) expected of the searched numbers."""

    log_det: float
    deviations: Floats
    tried: Trial = field(repr=False)
    excess: float
    price: float  # of an excess of 1

    @property
    def cost(self) -> float:
        return -0.5 * self.log_det + self.price * self.excess


@dataclass(frozen=True)
class Design:
    """A motion, and what to expect of it."""

    motion: Trajectory
    problem: Problem = field(repr=False)
    judgement: Judgement = field(repr=False)
    evaluations: int

    def left_open(self) -> list[str]:
        """Names of parameters that this motion will not settle either, by the arm file."""
        rows = zip(self.problem.parameters, self.judgement.deviations, strict=True)
        limits = self.problem.judging.uncertainty
        return [one.name for one, deviation in rows if deviation > open_beyond(one, limits)]

    def text(self) -> str:
        """One sentence."""
        rows = zip(self.problem.parameters, self.judgement.deviations, strict=True)
        motors = [float(deviation) for one, deviation in rows if one.kind in (*MOTOR, "coulomb")]
        left = self.left_open()
        return (
            f"As far as sensor noise goes, this motion tells half of the numbers of motors and friction to "
            f"{100 * float(np.median(motors)):.2g} % or better, the worst to {100 * max(motors):.2g} %"
            + (f"; it hardly tells {', '.join(left)} (`greywhale identify` says what these are)" if left else "")
            + "."
        )


def design(
    arm: ArmParameters,
    pose: npt.ArrayLike,
    *,
    table: ParameterTable | None = None,
    ranges: Mapping[int, tuple[float, float]] | None = None,
    seconds: float = SECONDS,
    seed: int = 0,
    budget: int = BUDGET,
    report: Progress | None = None,
    judging: IdentificationLimits = IDENTIFICATION_LIMITS,
) -> Design:
    """Search a motion from `pose` (4,) rad and back to it, for a board with this parameter table.

    `ranges` (rad) of single joints narrow or widen the usual range of 1 rad to either side of the pose. The result
    depends on the arguments only. Raises UserError where the arm cannot move like that.
    """
    check_effort(seconds, budget)
    at = np.asarray(pose, dtype=np.float64)
    running = table or ParameterTable.defaults().with_joints(arm.joints_in_use)
    problem = Problem.of(arm, running, at, ranges or {}, seed, judging)
    shape = Shape(problem.limits, seconds, judging.excitation)
    best = _search(problem, shape, seed, budget, report or show_no_progress)
    angles = shape.angles(best)
    judged = problem.judge(angles)
    for _ in range(SHRINKS):
        if judged.excess == 0.0:
            return Design(shape.trajectory(angles), problem, judged, budget)
        angles = at + judging.excitation.shrink * (angles - at)
        judged = problem.judge(angles)
    raise UserError(
        f"no motion was found that every arm like {arm.name} can follow with the controllers on the board: a joint "
        f"lags by {judged.tried.lag.max():.2f} rad; upload other controllers, or correct the arm file."
    )


def check_effort(seconds: float, budget: int) -> None:
    """Refuse lengths and budgets that make no sense, before anything is done."""
    require_between("the motion's length", seconds, "s", (SHORTEST_S, LONGEST_S))
    require_within("budget", budget, 1, MOST_BUDGET)


def _search(problem: Problem, shape: Shape, seed: int, budget: int, report: Progress) -> Floats:
    """The numbers of the best multi-sine. The first one tried has even speeds; a batch is tried side by side."""
    ones = np.ones(shape.size)
    with (
        create(DEFAULT, -ones, ones, budget=budget, seed=seed, start=np.zeros((1, shape.size))) as optimiser,
        ThreadPoolExecutor(os.cpu_count()) as pool,
    ):
        while not optimiser.done:
            costs = pool.map(lambda numbers: problem.judge(shape.angles(numbers)).cost, optimiser.ask())
            optimiser.tell(list(costs))
            report("designing the motion", optimiser.evaluations / budget)
        return optimiser.best.x
