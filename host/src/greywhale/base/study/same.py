"""The versions and the rounding that the bits of a result depend on beside the task. All workers must agree on them."""

from __future__ import annotations

import functools
import hashlib
import math
import sys
from collections.abc import Mapping
from importlib.metadata import version

import numpy as np

from greywhale.base.errors import UserError

# Other versions of these may compute other bits.
_PACKAGES = ("greywhale", "numpy", "scipy")
ROUNDING = "rounding"


@functools.cache
def versions() -> dict[str, str]:
    """The versions that a result depends on: from Python 3.12 on `sum` rounds otherwise than before."""
    python = ".".join(map(str, sys.version_info[:2]))
    return {"Python": python, **{name: version(name) for name in _PACKAGES}}


@functools.cache
def rounding() -> str:
    """A digest of some results of numpy, its linear algebra and the C library.

    Their last bits may differ between processors, because each library takes the instructions that a processor has,
    and between C libraries. numpy's linear algebra must have been told to use one thread.
    """
    steps = np.arange(1.0, 1025.0)
    rough = (steps * 0.6180339887498949) % 1.0  # no two alike, and none of few digits
    square = rough.reshape(32, 32)
    functions = (np.exp, np.log, np.sin, np.cos, np.tan, np.tanh, np.arctan, np.sqrt, np.cbrt, np.expm1, np.log1p)
    found = [function(rough) for function in functions]
    found += [rough**2.3, np.cumsum(rough), np.array([rough.sum(), rough @ rough, rough.std()])]
    found += [square @ square.T, np.linalg.solve(square + 4 * np.eye(32), rough[:32]), np.linalg.svd(square)[1]]
    found += [np.array([function(one) for one in rough]) for function in (math.exp, math.log, math.sin, math.tan)]
    found += [np.array([math.pow(one, 2.3) for one in rough])]
    return hashlib.sha256(b"".join(one.tobytes() for one in found)).hexdigest()[:12]


def facts() -> dict[str, str]:
    """All that a worker must share with the study that it works for."""
    return {**versions(), ROUNDING: rounding()}


def require_same(wanted: Mapping[str, str]) -> None:
    """UserError where a worker, which calls this, would compute other bits than the study's own process."""
    for name, found in facts().items():
        if found == wanted[name]:
            continue
        if name == ROUNDING:
            raise UserError(
                "a worker's processor or C library rounds otherwise than this machine's; start the study on a machine "
                "of the workers' kind, and give it workers of one kind only."
            )
        raise UserError(f"a worker has {name} {found}, but this study needs {wanted[name]}; install the same there.")
