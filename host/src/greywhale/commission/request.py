"""The request for a commissioning: a port, an arm, and how much effort to spend."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from greywhale.base.limits import changed
from greywhale.commission.limits import COMMISSIONING_LIMITS, CommissioningLimits

ROUNDS, TRIALS = 2, 8  # unless somebody asks for others


@dataclass(frozen=True)
class CommissioningRequest:
    """See the head of this file; without `arm_file` it starts from the model's arm or the white box."""

    port: str
    out: Path
    arm_file: str | None = None  # None: the model's arm, or the white box
    model: Path | None = None
    ranges: dict[int, tuple[float, float]] | None = None
    rounds: int = ROUNDS
    trials: int = TRIALS  # for each round
    seed: int = 0
    budget: int | None = None
    threads: int = 0
    resume: bool = False
    judging: CommissioningLimits = COMMISSIONING_LIMITS

    def facts(self) -> dict[str, Any]:
        """Return the facts that a journal must agree with."""
        others = changed(self.judging, COMMISSIONING_LIMITS)
        return {
            "arm": self.arm_file,
            "model": None if self.model is None else str(self.model),
            "ranges": {str(joint): list(pair) for joint, pair in sorted((self.ranges or {}).items())},
            "rounds": self.rounds,
            "trials": self.trials,
            "seed": self.seed,
            "budget": self.budget,
        } | ({"judging": others} if others else {})
