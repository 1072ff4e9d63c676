"""Two-level screening designs: many numbers are changed at once, and each one's effect is a difference of two means.

With n runs, n - 1 numbers can be told apart, as long as they do not work through each other (Plackett and Burman,
Biometrika 33, 1946). Chance is told in two ways, and the larger one counts: by runs in which only the seed differs, and
by the effects themselves, most of which are nothing (Lenth, Technometrics 31, 1989).
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import hadamard

from greywhale.base.types import Floats

Levels = NDArray[np.int64]


def screen(columns: int) -> Levels:
    """A small design: (runs, columns) of -1 and 1, each column half of each, all orthogonal."""
    runs = next(order for order in itertools.count(max(4, columns + 1)) if _core(order))
    core = _core(runs)
    of_twos: Levels = np.asarray(hadamard(runs // core), dtype=np.int64)
    whole: Levels = np.kron(of_twos, _paley(core - 1)) if core > 1 else of_twos
    design: Levels = whole[:, 1 : columns + 1] * whole[:, :1]
    return design


def _core(order: int) -> int:
    """Of a Hadamard matrix of that order the part that Paley made: 1 where powers of two are enough, 0 for none."""
    if order & (order - 1) == 0:
        return 1
    while order % 4 == 0:
        if all((order - 1) % divisor for divisor in range(2, order - 1)):
            return order
        order //= 2
    return 0


def _paley(prime: int) -> Levels:
    """A Hadamard matrix of order prime + 1, where the prime is 3 modulo 4 (Paley, 1933)."""
    squares = {number * number % prime for number in range(1, prime)}
    places = np.subtract.outer(np.arange(prime), np.arange(prime)) % prime
    character = np.array([0, *(1 if number in squares else -1 for number in range(1, prime))])
    skew = np.zeros((prime + 1, prime + 1), dtype=np.int64)
    skew[0, 1:], skew[1:, 0], skew[1:, 1:] = 1, -1, character[places]
    paley: Levels = skew + np.eye(prime + 1, dtype=np.int64)
    return paley


def effects(design: Levels, response: Floats) -> Floats:
    """(columns,) The mean of the runs at a column's upper level, less that of those at its lower one."""
    found: Floats = design.T @ response / (0.5 * len(design))
    return found


def standard_error(found: Floats, runs: int, by_seed: Floats) -> float:
    """Of one effect; `by_seed` is the response of runs in which only the seed differs."""
    of_seeds = 2.0 * float(by_seed.std(ddof=1)) / math.sqrt(runs)
    return max(of_seeds, _pseudo_error(found))


def _pseudo_error(found: Floats) -> float:
    """Lenth's: 1.5 medians of the effects' sizes, without those that stand out."""
    size = np.abs(found)
    first = 1.5 * float(np.median(size))
    return 1.5 * float(np.median(size[size <= 2.5 * first]))
