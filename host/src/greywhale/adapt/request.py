"""What an adaptation is asked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from greywhale.base.study.workers import Workers

# Evaluations of one search in the background.
BUDGET = 300
SECONDS = 600.0


@dataclass(frozen=True)
class AdaptationRequest:
    """`seconds` of work on a port, by the board's clock. Controllers that are kept go into the file `out`.

    `workers` do the searches; in this process alone (`SerialWorkers`) the board would wait for them, so only a bench in
    lock step can bear that.
    """

    port: str
    model: Path
    out: Path
    workers: Workers
    seconds: float = SECONDS
    budget: int = BUDGET
    seed: int = 0
