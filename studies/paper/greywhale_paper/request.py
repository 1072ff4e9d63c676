"""How much of the paper is done: all of it, or a quick look at all of it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from greywhale.base.errors import MOST_SEED, require_within
from greywhale_paper.work.motions import PERIOD_MS
from greywhale_paper.work.readings import READINGS, Reading

SEEDS, QUICK_SEEDS = 10, 4
MOST_SEEDS = 1000
# greywhale's own tuning takes a hundred times the paper's, so it is done for fewer seeds.
DEFAULT_SEEDS, QUICK_DEFAULT_SEEDS = 3, 1
# Arms drawn around the white box, and the seeds on each.
DRAWN_ARMS, QUICK_DRAWN_ARMS, DRAWN_SEEDS = 3, 0, 4


@dataclass(frozen=True)
class Request:
    """`seeds` runs of everything random, counted from `seed`."""

    seed: int = 0  # the first
    seeds: int = SEEDS  # runs of everything random
    quick: bool = False  # whether logs, seeds and budgets are cut

    def __post_init__(self) -> None:
        require_within("seed", self.seed, 0, MOST_SEED - MOST_SEEDS)
        require_within("seeds", self.seeds, 1, MOST_SEEDS)

    @classmethod
    def of(cls, seed: int, seeds: int | None, quick: bool) -> Request:
        """With the usual number of seeds where none is given."""
        usual = QUICK_SEEDS if quick else SEEDS
        return cls(seed, usual if seeds is None else seeds, quick)

    @property
    def every_seed(self) -> tuple[int, ...]:
        """For what is cheap."""
        return tuple(range(self.seed, self.seed + self.seeds))

    @property
    def few_seeds(self) -> tuple[int, ...]:
        """For greywhale's own tuning."""
        return self.every_seed[: QUICK_DEFAULT_SEEDS if self.quick else DEFAULT_SEEDS]

    @property
    def arm_seeds(self) -> tuple[int, ...]:
        """For arms that were drawn."""
        return self.every_seed[:DRAWN_SEEDS]

    @property
    def drawn(self) -> tuple[str, ...]:
        return tuple(f"drawn {number + 1}" for number in range(QUICK_DRAWN_ARMS if self.quick else DRAWN_ARMS))

    @property
    def readings(self) -> tuple[Reading, ...]:
        """Of the controllers; a control period of 1 ms takes much longer to simulate."""
        return tuple(one for one in READINGS if not self.quick or one.period_ms == PERIOD_MS)

    @property
    def tuning_budget(self) -> int | None:
        """Of greywhale's own tuning; None is its default."""
        return 300 if self.quick else None

    @property
    def logged_s(self) -> float:
        """Length of the recordings for the identification."""
        return 10.0 if self.quick else 20.0

    @property
    def function_runs(self) -> int:
        """Of each optimiser on each standard function."""
        return max(self.seeds, 7 if self.quick else 25)

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)
