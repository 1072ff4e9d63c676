"""GWO-WOA as good as it can be: the paper's optimiser, agents and iterations on a problem that suits them.

It searches what a motion can show: logarithms of the three combinations of a joint's motor values, and of its Coulomb
friction, which the paper leaves out. The white box is in the first pack, so no model is worse than it on the fitted
logs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greywhale.base.types import Floats
from greywhale.identify.default import estimates_of
from greywhale.identify.found_model import FoundModel
from greywhale.identify.limits import IDENTIFICATION_LIMITS
from greywhale.identify.pack_search import PackSearch
from greywhale.identify.request import IdentificationRequest
from greywhale.identify.space import MOTOR, Space
from greywhale.protocol.firmware import JOINTS

METHOD = "gwo-woa"


@dataclass
class LogarithmicSearch(PackSearch):
    """The search over logarithms around the white box."""

    said = "GWO-WOA on logarithms"

    joints: tuple[int, ...] = tuple(range(JOINTS))
    farthest_log: float = IDENTIFICATION_LIMITS.search.farthest_log  # from the white box

    def __post_init__(self) -> None:
        self.space = Space.of(self.arm, (*MOTOR, "coulomb"), self.joints)

    def bounds(self) -> tuple[Floats, Floats]:
        (low, high), middle = self.space.bounds(), self.space.start()
        return np.maximum(low, middle - self.farthest_log), np.minimum(high, middle + self.farthest_log)

    def start(self) -> Floats:
        return self.space.start()[None]

    def plants(self, points: Floats) -> Floats:
        return self.space.plants(points)


def find_by_gwo_woa(task: IdentificationRequest) -> FoundModel:
    """Run the search. An interrupt after the first pack ends it early; before that, the interrupt is raised again."""
    search = LogarithmicSearch(
        task.white_box,
        task.required_loops(),
        task.seed,
        task.report,
        joints=task.moving,
        farthest_log=task.limits.search.farthest_log,
    )
    search.run()
    assert search.x is not None
    return FoundModel(
        plant=search.plants(search.x[None])[0],
        zero=np.zeros(JOINTS),
        joints=task.moving,
        order="motors, Coulomb friction",
        estimates=estimates_of(search.space, search.x, None),
        open=(),
        simulations=search.simulations,
        simulated=search.seconds,
        complete=search.complete,
        curve=tuple(search.curve),
    )
