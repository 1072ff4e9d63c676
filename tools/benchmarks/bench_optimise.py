"""What an optimiser costs beside the evaluations, and where the default stands against differential evolution."""

from __future__ import annotations

import time

import numpy as np

from greywhale.optimise import DEFAULT, minimise
from greywhale.optimise.comparison import Plan, compare
from tools.benchmarks.figure import Figure

BUDGET = 5_000
RIVAL = "de"


def overhead(method: str) -> float:
    """Microseconds an evaluation, the best of three runs on costs that take next to no time; 20 coordinates."""
    seconds = []
    for seed in range(3):
        begin = time.perf_counter()
        minimise(lambda points: points[:, 0], np.zeros(20), np.ones(20), method=method, budget=BUDGET, seed=seed)
        seconds.append(time.perf_counter() - begin)
    return min(seconds) / BUDGET * 1e6


def run() -> list[Figure]:
    figures = [Figure(f"overhead, {method}", overhead(method), "us/eval") for method in (DEFAULT, "gwo-woa", RIVAL)]
    ranks = compare(Plan(settings=("shifted",), methods=(DEFAULT, RIVAL), runs=15)).mean_ranks("shifted")
    ahead = ranks[DEFAULT] <= ranks[RIVAL]
    figures.append(Figure(f"rank, {DEFAULT} of 2, shifted, 500", ranks[DEFAULT], "", f"<= {RIVAL}'s", ahead))
    return figures
