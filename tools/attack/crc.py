"""How much damage passes a CRC-16 unnoticed: computed from the code itself.

The errors that a linear code does not notice are its words. Their weights follow from those of the dual code, which has
2^16 words only (MacWilliams' identity).
"""

from __future__ import annotations

from functools import cache
from math import comb

import numpy as np

POLYNOMIAL, WIDTH = 0x1021, 16
RANDOM = 2.0**-WIDTH  # of damage without any order


@cache
def _dual_weights(bits: int) -> tuple[int, ...]:
    """How many words of the dual code have weight 0..bits. `bits` counts data and CRC."""
    rows = np.array([mask.bit_count() & 1 for mask in range(1 << WIDTH)], np.uint16)
    masks = np.arange(1 << WIDTH, dtype=np.uint16)
    weights = np.zeros(1 << WIDTH, np.uint16)
    column = 1
    for _ in range(bits):
        weights += rows[masks & np.uint16(column)]
        column = (column << 1 ^ (POLYNOMIAL if column >> (WIDTH - 1) else 0)) & 0xFFFF
    return tuple(int(count) for count in np.bincount(weights, minlength=bits + 1))


@cache
def unnoticed_patterns(bits: int, weight: int) -> int:
    """In how many ways `weight` flipped bits of `bits` leave the CRC right."""
    total = 0
    for dual, count in enumerate(_dual_weights(bits)):
        if count:
            # The coefficient of z^weight in (1 - z)^dual (1 + z)^(bits - dual).
            terms = ((-1) ** k * comb(dual, k) * comb(bits - dual, weight - k) for k in range(min(dual, weight) + 1))
            total += count * sum(terms)
    found, rest = divmod(total, 1 << WIDTH)
    assert rest == 0
    return found


def unnoticed_share(bits: int, weight: int, among: int | None = None) -> float:
    """The share of all ways to flip `weight` of `among` bits (all `bits` by default) that is in these and unnoticed."""
    return unnoticed_patterns(bits, weight) / comb(bits if among is None else among, weight)


def too_many(found: int, expected: float) -> int:
    """By how much a count is above what chance explains: 0 but for once in some 10^9 times."""
    return max(0, found - int(expected + 6 * expected**0.5 + 6))
