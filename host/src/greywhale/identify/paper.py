"""The paper's identification, with the model inside the known controller.

It searches 20 motor values within Table 2's bounds by GWO-WOA with 10 agents and 50 iterations (Fig. 5: the first pack
and 50 moves, 510 evaluations), for the least summed mean squared error of Eq. 5. The paper feeds "the same input" to
arm and model. Taken literally (leader angles as volts) that is not well posed; inside the same controller it is.

The estimated values are "included in the optimisation process" (section 2). Whether that puts the white box into the
first pack is open: `paper` draws the pack at random, `paper-started` does not.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.plants import column
from greywhale.base.types import Floats
from greywhale.identify.found_model import FoundModel, ParameterEstimate
from greywhale.identify.pack_search import PackSearch
from greywhale.identify.request import IdentificationRequest
from greywhale.loop import plant_row
from greywhale.protocol.firmware import JOINTS

VALUES = ("inertia", "resistance", "torque_constant", "viscous", "gear_ratio")
# Table 2. It prints 19 lower bounds for 20 values: the third joint's is missing a 0. Zero itself would divide by zero.
LEAST = 1e-6
LOWER = (LEAST, 0.01, LEAST, LEAST, LEAST)
UPPER = (100.0,) * 5
# Method -> optimiser, and whether the white box is in the first pack.
METHODS = {"paper": ("gwo-woa", False), "paper-printed": ("gwo-woa-printed", False), "paper-started": ("gwo-woa", True)}


@dataclass
class PaperSearch(PackSearch):
    """The search over 20 motor values, by their own size."""

    said = "GWO-WOA as in the paper"

    started: bool = False

    def bounds(self) -> tuple[Floats, Floats]:
        return np.tile(LOWER, JOINTS), np.tile(UPPER, JOINTS)

    def start(self) -> Floats | None:
        return motor_values(self.arm)[None] if self.started else None

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


def motor_values(arm: ArmParameters) -> Floats:
    """The 20 values (20,) of Table 4 that an arm has."""
    return np.array([getattr(joint.motor, name) for joint in arm.joint for name in VALUES])


def find_as_paper(task: IdentificationRequest, method: str) -> FoundModel:
    """Run the search. An interrupt after the first pack ends it early; before that, the interrupt is raised again."""
    optimiser, started = METHODS[method]
    search = PaperSearch(task.white_box, task.required_loops(), task.seed, task.report, optimiser, started=started)
    search.run()
    assert search.x is not None
    return FoundModel(
        plant=search.plants(search.x[None])[0],
        zero=np.zeros(JOINTS),
        joints=tuple(range(JOINTS)),
        order="motors",
        estimates=tuple(_estimates(task.white_box, search.x)),
        open=("two of the five motor values of every joint: motion shows three combinations of them only",),
        simulations=search.simulations,
        simulated=search.seconds,
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
