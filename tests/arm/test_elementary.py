"""The arm's sine, cosine, logarithm and exponential: near numpy's of more digits, and no C library's in their place."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from greywhale import _native
from greywhale.base.types import Floats

HERE = Path(__file__).parent
QUARTER = np.pi / 2
# Of the C library, rounded as each library likes; what is left out is exact, such as sqrt and round.
INEXACT = "acos acosh asin asinh atan atan2 atanh cbrt cos cosh exp exp2 expm1 hypot log log10 log1p log2 pow"
INEXACT += " sin sincos sinh tan tanh"


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("elementary") / "elementary"
    flags = ["-std=c++17", "-O2", "-ffp-contract=off", f"-I{HERE.parents[1] / 'sim' / 'arm'}"]
    subprocess.run(["g++", *flags, str(HERE / "elementary.cpp"), "-o", str(made)], check=True)
    return made


def worst_ulps(program: Path, column: int, function: np.ufunc, of: Floats) -> float:
    """The largest error, in last bits of the true value as numpy's long double has it."""
    done = subprocess.run([str(program)], input=of.tobytes(), stdout=subprocess.PIPE, check=True)
    found = np.frombuffer(done.stdout).reshape(-1, 5)[:, column]
    true = function(of.astype(np.longdouble))
    return float((np.abs(found - true) / np.spacing(np.abs(true.astype(np.float64)))).max())


def angles() -> Floats:
    """From tiny ones to 2^16 quarter turns, both ways, and next to where sine or cosine is 0."""
    random = np.random.default_rng(1)
    tops = [1e-300, 1e-9, 0.1, 0.8, 4.0, 100.0, 1e4, 2.0**16 * QUARTER]
    spread = [top * random.uniform(-1.0, 1.0, 20_000) for top in tops]
    zeros = QUARTER * np.concatenate([np.arange(-2000.0, 2000.0), random.integers(-(2**16), 2**16, 20_000)])
    return np.concatenate([*spread, zeros, np.nextafter(zeros, np.inf), np.nextafter(zeros, -np.inf)])


@pytest.mark.parametrize(("column", "function"), [(0, np.sin), (1, np.cos)])
def test_sine_and_cosine_are_within_the_last_bit(program: Path, column: int, function: np.ufunc) -> None:
    assert worst_ulps(program, column, function, angles()) < 0.9


def test_logarithms_are_within_the_last_bits(program: Path) -> None:
    random = np.random.default_rng(2)
    ways = (random.uniform(0.0, 2.0, 100_000), 1.0 + random.uniform(-1e-6, 1e-6, 20_000))
    of = np.concatenate([*ways, 2.0 ** random.uniform(-1022.0, 1023.9, 100_000), 2.0 ** np.arange(-1022.0, 1024.0)])
    assert worst_ulps(program, 2, np.log, of) < 1.0
    assert worst_ulps(program, 3, np.log1p, of) < 1.5


def test_the_exponential_is_within_the_last_bit(program: Path) -> None:
    random = np.random.default_rng(3)
    of = np.concatenate([top * random.uniform(-1.0, 1.0, 50_000) for top in (1e-9, 0.3, 1.0, 20.0, 708.0)])
    assert worst_ulps(program, 4, np.exp, of) < 0.9


def test_nothing_is_taken_from_the_c_library_that_it_may_round_in_its_own_way() -> None:
    listed = ["nm", "--dynamic", "--undefined-only", "--just-symbols", _native.__file__]
    table = subprocess.run(listed, check=True, capture_output=True, text=True).stdout.split()
    taken = {symbol.partition("@")[0] for symbol in table}
    assert "memcpy" in taken, "this is how the names look"
    assert taken.isdisjoint({name + kind for name in INEXACT.split() for kind in ("", "f", "l")})
