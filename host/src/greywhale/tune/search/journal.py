"""The journal of a tuning: every cost that an optimiser was told, so that an interrupted tuning can go on.

It is a file of checked lines (formats/checked_lines.py). The first says what was asked for. Each further line holds the
costs of one batch and a digest of its candidates. Resuming plays the optimisers through the same batches with the costs
from the file, without simulation, and then goes on. File and result become the same, byte for byte, as those of a run
without a break.
"""

from __future__ import annotations

import zlib
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.base.closing import Closing
from greywhale.base.errors import UserError
from greywhale.base.formats.checked_lines import CheckedLines, Kind
from greywhale.base.types import Controllers, Floats


class TuningJournal(Closing):
    """The costs in the order in which they are told. Without a path nothing is kept. Use as a context."""

    def __init__(self, path: Path | None, request: dict[str, Any], resume: bool = False) -> None:
        self._lines = None if path is None else CheckedLines(path, KIND, request, keep=resume)
        self._told = [] if self._lines is None else self._lines.found
        self._next = 0

    @property
    def replaying(self) -> bool:
        """True where the next batch's costs are known already."""
        return self._next < len(self._told)

    def costs(self, stage: str, candidates: Controllers) -> Floats | None:
        """The costs of the next batch, if the journal has them."""
        if self._lines is None or not self.replaying:
            return None
        line = self._told[self._next]
        if line["stage"] != stage or line["candidates"] != _digest(candidates):
            raise UserError(
                f"{self._lines.path}: batch {self._next + 1} of the journal is of other candidates ({line['stage']}) "
                f"than this version of greywhale asks for ({stage}); start anew without --resume."
            )
        self._next += 1
        return np.array(line["costs"], dtype=np.float64)

    def tell(self, stage: str, candidates: Controllers, costs: Floats) -> None:
        """Append a batch's costs; when this returns they are on their way to the disk."""
        if self._lines is not None:
            self._lines.append({"stage": stage, "candidates": _digest(candidates), "costs": costs.tolist()})

    def close(self) -> None:
        """Close the file; it is on the disk then."""
        if self._lines is not None:
            self._lines.close()


def _is_batch(value: dict[str, Any]) -> bool:
    costs = value.get("costs")
    return (
        isinstance(value.get("stage"), str)
        and isinstance(value.get("candidates"), int)
        and isinstance(costs, list)
        and bool(costs)
        and all(isinstance(row, list) and len(row) == 4 for row in costs)
        and all(isinstance(cost, float) for row in costs for cost in row)
    )


def _digest(candidates: Controllers) -> int:
    return zlib.crc32(np.ascontiguousarray(candidates, dtype="<i4").tobytes())


KIND = Kind(
    mark="greywhale_tune_journal",
    version=3,
    noun="journal",
    subject="tuning",
    anew="start anew without --resume",
    again="with --resume",
    is_line=_is_batch,
    choices=("strategy", "method", "budget", "seed", "bounds", "before"),
)
