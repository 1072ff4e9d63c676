"""Whether two samples of costs differ by more than chance: Mann-Whitney, with Holm's correction for many questions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from math import comb

import numpy as np
from scipy.stats import mannwhitneyu, rankdata

from greywhale.base.types import Floats

# Two samples count as different when chance would separate them as far in fewer cases than this share.
SIGNIFICANCE = 0.05


@dataclass(frozen=True)
class Verdict:
    """A method against a rival: its costs are `lower`, `higher` or `not told apart`; `chance` is Holm's p."""

    word: str
    chance: float

    def __str__(self) -> str:
        return f"{self.word}, p = {self.chance:.2g}"


def fewest(questions: int = 1) -> int:
    """The fewest runs of each method with which one of so many pairs can be told apart, however far they are apart."""
    return next(runs for runs in count(1) if questions * 2.0 / comb(2 * runs, runs) < SIGNIFICANCE)


def against(costs: Mapping[str, Sequence[float] | Floats], method: str) -> dict[str, Verdict]:
    """`method` against every other."""
    return against_each({"": costs}, method)[""]


def against_each(
    problems: Mapping[str, Mapping[str, Sequence[float] | Floats]], method: str
) -> dict[str, dict[str, Verdict]]:
    """The same on several problems: each pair on each problem is one of the many questions that Holm corrects for."""
    pairs = [(problem, rival) for problem, costs in problems.items() for rival in costs if rival != method]
    samples = [(np.array(problems[problem][method]), np.array(problems[problem][rival])) for problem, rival in pairs]
    found: dict[str, dict[str, Verdict]] = {problem: {} for problem in problems}
    corrected = holm([_chance(*both) for both in samples])
    for (problem, rival), both, chance in zip(pairs, samples, corrected, strict=True):
        found[problem][rival] = Verdict(_word(*both, chance), chance)
    return found


def _chance(own: np.ndarray, other: np.ndarray) -> float:
    if np.array_equal(np.sort(own), np.sort(other)):
        return 1.0
    return float(mannwhitneyu(own, other).pvalue)


def _word(own: np.ndarray, other: np.ndarray, chance: float) -> str:
    if chance >= SIGNIFICANCE:
        return "not told apart"
    return "lower" if (own[:, None] < other).sum() > (own[:, None] > other).sum() else "higher"


def holm(chances: Sequence[float]) -> list[float]:
    """Holm's corrected values, in the order given."""
    order = np.argsort(chances)
    corrected, highest = [0.0] * len(chances), 0.0
    for place, index in enumerate(order):
        highest = max(highest, min(1.0, (len(chances) - place) * chances[index]))
        corrected[index] = highest
    return corrected


def mean_ranks(costs: Mapping[str, Sequence[float] | Floats]) -> dict[str, float]:
    """Rank 1 is the lowest of a run; the mean over the runs, ties shared."""
    ranks = rankdata(np.array(list(costs.values())), axis=0).mean(axis=1)
    return dict(zip(costs, map(float, ranks), strict=True))
