"""The paper's identification, with the model inside the known controller.

It searches 20 motor values within Table 2's bounds by GWO-WOA with 10 agents and 50 iterations (Fig. 5: the first pack
and 50 moves, 510 evaluations), for the least summed mean squared error of Eq. 5. The paper feeds "the same input" to
arm and model. Taken literally (leader angles as volts) that is not well posed; inside the same controller it is.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.plants import column
from greywhale.base.types import Floats, Progress
from greywhale.identify.closed_loop import Loop
from greywhale.identify.found_model import FoundModel, ParameterEstimate
from greywhale.identify.request import IdentificationRequest
from greywhale.optimise import create
from greywhale.protocol.firmware import JOINTS
from greywhale.simulate import plant_row

AGENTS = 10
ITERATIONS = 50
BUDGET = AGENTS * (ITERATIONS + 1)
VALUES = ("inertia", "resistance", "torque_constant", "viscous", "gear_ratio")
# Table 2. It prints 19 lower bounds for 20 values: the third joint's is missing a 0. Zero itself would divide by zero.
LEAST = 1e-6
LOWER = (LEAST, 0.01, LEAST, LEAST, LEAST)
UPPER = (100.0,) * 5
METHODS = {"paper": "gwo-woa", "paper-printed": "gwo-woa-printed"}


@dataclass
class PaperSearch:
    """The search and the best that it has found so far."""

    arm: ArmParameters
    loops: Sequence[Loop]
    seed: int
    report: Progress
    method: str = "paper"
    x: Floats | None = None
    curve: list[float] = field(default_factory=list)  # best cost of the first pack and after each iteration: Fig. 6
    simulations: int = 0
    complete: bool = False

    def run(self) -> None:
        low, high = np.tile(LOWER, JOINTS), np.tile(UPPER, JOINTS)
        name = METHODS[self.method]
        with create(name, low, high, budget=BUDGET, seed=self.seed, pack=AGENTS) as pack:
            while not pack.done:
                points = pack.ask()
                costs = self.costs(points)
                pack.tell(costs)
                self.simulations += len(points)
                self.x = pack.best.x.copy()
                self.curve.append(float(pack.best.cost))
                self.report("GWO-WOA as in the paper", self.simulations / BUDGET)
        self.complete = True

    def costs(self, points: Floats) -> Floats:
        plants = self.plants(points)
        total: Floats = np.mean([loop.error(plants).sum(axis=1) for loop in self.loops], axis=0)
        return total

    def plants(self, points: Floats) -> Floats:
        """The paper's Eq. 1 in the only reading with consistent units; no friction, no backlash."""
        rows = np.tile(plant_row(self.arm), (len(points), 1))
        for joint in range(JOINTS):
            inertia, resistance, constant, viscous, ratio = points[:, 5 * joint : 5 * joint + 5].T
            torque = constant / resistance
            rows[:, column("torque_per_volt", joint)] = torque
            rows[:, column("resistance", joint)] = resistance
            rows[:, column("inertia", joint)] = inertia * ratio
            rows[:, column("damping", joint)] = torque * constant * ratio + viscous
            for name in ("coulomb", "breakaway", "half_gap", "stiffness", "mesh_damping", "drag"):
                rows[:, column(name, joint)] = 0.0
        return rows


def find_as_paper(task: IdentificationRequest, method: str) -> FoundModel:
    """Run the search. An interrupt after the first pack ends it early; before that, the interrupt is raised again."""
    loops = task.required_loops()
    search = PaperSearch(task.white_box, loops, task.seed, task.report, method)
    try:
        search.run()
    except KeyboardInterrupt:
        if search.x is None:
            raise
    assert search.x is not None
    return FoundModel(
        plant=search.plants(search.x[None])[0],
        zero=np.zeros(JOINTS),
        joints=tuple(range(JOINTS)),
        order="motors",
        estimates=tuple(_estimates(task.white_box, search.x)),
        open=("two of the five motor values of every joint: motion shows three combinations of them only",),
        simulations=search.simulations,
        simulated=search.simulations * sum(loop.seconds for loop in loops),
        complete=search.complete,
        curve=tuple(search.curve),
    )


def _estimates(white_box: ArmParameters, x: Floats) -> Iterator[ParameterEstimate]:
    """The 20 values of Table 4, before and after."""
    for joint in range(JOINTS):
        before = white_box.joint[joint].motor.model_dump()
        for n, name in enumerate(VALUES):
            value = float(x[len(VALUES) * joint + n])
            yield ParameterEstimate(f"joint{joint}.{name}", "motor value of Table 4", "", before[name], value, None)
