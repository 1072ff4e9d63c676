"""Global optimisation within a box by ask and tell: the paper's GWO-WOA, a translation-invariant one, and their peers.

    minimum = minimise(cost, lower, upper, budget=500, seed=1)

`cost` takes a batch (rows) and returns a cost a row; `mapped(cost_of_one_point, executor.map)` makes one. For a loop of
your own, `create(...)` returns an object with `ask()` and `tell(costs)`.
"""

from greywhale.optimise.box import Box
from greywhale.optimise.methods import DEFAULT, METHODS, Minimum, Step, create, mapped, minimise
from greywhale.optimise.optimiser import Best, History, Optimiser

__all__ = [
    "DEFAULT",
    "METHODS",
    "Best",
    "Box",
    "History",
    "Minimum",
    "Optimiser",
    "Step",
    "create",
    "mapped",
    "minimise",
]
