"""The limits of a tuning: what a model must be, what a search trains on and pays for, and who is chosen at the end.

`tune(..., judging=...)` takes others. Counts of evaluations, seeds and the paper's own setting are no limits: they
stand where they are used.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from greywhale.base.limits import limit
from greywhale.identify.limits import IDENTIFICATION_LIMITS, IdentificationLimits
from greywhale.measure.limits import SWING_BOUNDS, SwingBounds
from greywhale.tune.limits.judge import ChoiceLimits, FloorLimits, FollowingLimits, MarginLimits
from greywhale.tune.limits.model import ModelLimits, TravelLimits
from greywhale.tune.limits.search import CostLimits, SpaceLimits, TrainingLimits

__all__ = [
    "BY_THE_ARM",
    "TUNING_LIMITS",
    "WITHOUT_FLOORS",
    "ChoiceLimits",
    "CostLimits",
    "FloorLimits",
    "FollowingLimits",
    "MarginLimits",
    "ModelLimits",
    "SpaceLimits",
    "TrainingLimits",
    "TravelLimits",
    "TuningLimits",
]


@dataclass(frozen=True)
class TuningLimits:
    """All limits of a tuning, and who has the last word about what it finds."""

    quiet: float = limit(1.0, "", "divides the ripple that is allowed at rest", "what a person asks for")
    by_the_arm: bool = limit(False, "", "the arm itself will judge: unrest on the model counts less")
    floors: bool = limit(True, "", "work out the least possible error on other motions")
    model: ModelLimits = field(default=ModelLimits())
    travel: TravelLimits = field(default=TravelLimits())
    training: TrainingLimits = field(default=TrainingLimits())
    space: SpaceLimits = field(default=SpaceLimits())
    cost: CostLimits = field(default=CostLimits())
    floor: FloorLimits = field(default=FloorLimits())
    margins: MarginLimits = field(default=MarginLimits())
    choice: ChoiceLimits = field(default=ChoiceLimits())
    following: FollowingLimits = field(default=FollowingLimits())
    swings: SwingBounds = SWING_BOUNDS
    identification: IdentificationLimits = IDENTIFICATION_LIMITS  # of the models that it is for


TUNING_LIMITS = TuningLimits()
WITHOUT_FLOORS = replace(TUNING_LIMITS, floors=False)
# A commissioning tries on the arm what a tuning finds.
BY_THE_ARM = replace(WITHOUT_FLOORS, by_the_arm=True)
