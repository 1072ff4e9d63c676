"""scipy's differential evolution behind ask and tell.

scipy calls the cost function itself, so its public function runs in a thread of its own. `ask` hands out what it wants
to know, and `tell` takes the answers in. Only one of the two threads runs at a time, so a run is as repeatable as
scipy's. The thread ends with the budget, with close(), or when the optimiser is forgotten. Bounds: scipy draws a
coordinate that leaves the box anew.
"""

from __future__ import annotations

import threading
import weakref
from queue import SimpleQueue
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from greywhale.base.types import Floats
from greywhale.optimise.box import Box, latin_hypercube
from greywhale.optimise.optimiser import PACK, Optimiser

# Finite, because scipy evaluates a first pack of infinities a second time; far enough from the limit that sums stay
# finite.
WORST_COST = 1e300


class _Closed(BaseException):
    """Ends scipy from inside the cost function; no Exception, which scipy might catch."""


class _Channel:
    """Passes points and costs between scipy's thread and the optimiser's; knows neither."""

    def __init__(self) -> None:
        self._batches: SimpleQueue[Floats | BaseException] = SimpleQueue()
        self.costs: SimpleQueue[Floats | None] = SimpleQueue()

    def cost(self, columns: Floats) -> Floats:
        """The cost function as scipy sees it."""
        self._batches.put(columns.T.copy())
        costs = self.costs.get()
        if costs is None:
            raise _Closed
        return costs

    def run(self, options: dict[str, Any]) -> None:
        try:
            # Imported here: it takes a second, and most runs need no scipy.
            from scipy.optimize import differential_evolution

            # The spread of the costs that stand for "worst" may overflow; nothing depends on it.
            with np.errstate(all="ignore"):
                differential_evolution(self.cost, **options)
        except _Closed:
            return
        except BaseException as error:
            self._batches.put(error)
        else:
            self._batches.put(RuntimeError("scipy's differential evolution ended by itself"))

    def next_batch(self) -> Floats:
        batch = self._batches.get()
        if isinstance(batch, BaseException):
            raise batch
        return batch


class DifferentialEvolution(Optimiser):
    """`scipy.optimize.differential_evolution` with its own defaults and a pack of the others' size.

    It has no polish (which would be another method) and no early end.
    """

    name: ClassVar[str] = "de"
    smallest_pack: ClassVar[int] = 5
    _scatter = staticmethod(latin_hypercube)

    def __init__(
        self,
        box: Box,
        budget: int,
        source: np.random.Generator,
        *,
        pack: int = PACK,
        start: ArrayLike | None = None,
        **scipy_options: Any,
    ) -> None:
        super().__init__(box, budget, source, pack=pack, start=start)
        self._options: dict[str, Any] = {
            **scipy_options,
            "bounds": list(zip(box.lower, box.upper, strict=True)),
            "rng": source,
            "updating": "deferred",
            "vectorized": True,
            "polish": False,
            "maxiter": 2**31 - 1,  # the budget ends the run before
            # Never converged: a negative tolerance is below every spread.
            "tol": 0.0,
            "atol": -1.0,
        }
        self._channel = _Channel()
        self._thread: threading.Thread | None = None
        self._finalizer = weakref.finalize(self, self._channel.costs.put, None)

    def _propose(self) -> Floats:
        if self._thread is None:
            self._options["init"] = self._first_pack()
            self._thread = threading.Thread(
                target=self._channel.run, args=(self._options,), name="differential evolution", daemon=True
            )
            self._thread.start()
        return self.box.clip(self._channel.next_batch())

    def _learn(self, candidates: Floats, costs: Floats) -> None:
        self._channel.costs.put(np.where(np.isfinite(costs), costs, WORST_COST))

    def close(self) -> None:
        self._finalizer()
        if self._thread is not None:
            self._thread.join()
