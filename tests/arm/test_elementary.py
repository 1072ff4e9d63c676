"""The arm's own sine, cosine and logarithm, against numpy's in extended precision."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

ROOT = Path(__file__).parents[2]
SOURCE = """
#include "elementary.h"
using namespace greywhale::arm;
#define EACH(name, term) \\
  extern "C" void name(int count, const double* x, double* y) { for (int n = 0; n < count; ++n) { term; } }
EACH(own_sin, double other; sine_cosine(x[n], y[n], other))
EACH(own_cos, double other; sine_cosine(x[n], other, y[n]))
EACH(own_log, y[n] = logarithm(x[n]))
EACH(own_log1p, y[n] = logarithm_of_one_plus(x[n]))
"""
Floats = npt.NDArray[np.float64]


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, Floats], Floats]:
    library = tmp_path_factory.mktemp("own") / "own.so"
    command = ["g++", "-xc++", "-std=c++17", "-O2", "-ffp-contract=off", "-shared", "-fPIC", f"-I{ROOT / 'sim/arm'}"]
    subprocess.run([*command, "-o", library, "-"], input=SOURCE, text=True, check=True)
    functions = ctypes.CDLL(str(library))

    def call(name: str, x: Floats) -> Floats:
        y = np.empty_like(x)
        getattr(functions, f"own_{name}")(len(x), *(ctypes.c_void_p(one.ctypes.data) for one in (x, y)))
        return y

    return call


@pytest.mark.parametrize(
    ("name", "low", "high"), [("sin", -60.0, 60.0), ("cos", -60.0, 60.0), ("log", 1e-17, 1.0), ("log1p", 1e-9, 50.0)]
)
def test_own_functions_are_right_to_a_few_ulp(
    own: Callable[[str, Floats], Floats], name: str, low: float, high: float
) -> None:
    x = np.random.default_rng(1).uniform(low, high, 100_000)
    exact = getattr(np, name)(x.astype(np.longdouble))
    error = np.abs(own(name, x) - exact) / np.spacing(np.abs(exact).astype(np.float64))
    assert error.max() < (2.5 if name == "log1p" else 1.5)


def test_quarter_turns_are_as_exact_as_their_angles(own: Callable[[str, Floats], Floats]) -> None:
    x = np.concatenate([np.arange(-40, 41) * (np.pi / 2.0), [0.0, 1e-300, 1e6, -1e9]])
    for name in ("sin", "cos"):
        np.testing.assert_allclose(own(name, x), getattr(np, name)(x.astype(np.longdouble)).astype(float), atol=1e-16)
