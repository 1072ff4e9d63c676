"""Exponential, logarithm and cosine with the same bits on every machine (sim/arm/elementary.h); numpy's differ.

A search that asks for them walks the same way everywhere, in a page too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from greywhale import _native
from greywhale.base.types import Floats


def exp(x: ArrayLike) -> Floats:
    """For x from -708 to 709; beyond, as there."""
    return np.asarray(_native.exponential(np.ascontiguousarray(x, dtype=np.float64)))


def log(x: ArrayLike) -> Floats:
    """For normal numbers above 0."""
    return np.asarray(_native.logarithm(np.ascontiguousarray(x, dtype=np.float64)))


def cos(x: ArrayLike) -> Floats:
    return np.asarray(_native.cosine(np.ascontiguousarray(x, dtype=np.float64)))
