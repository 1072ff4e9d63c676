"""Octave evaluates the exported .fis afresh: what is committed for `make test` is what it says today."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from fuzzy_octave import octave_grid, paper_sets

GOLDEN = np.load(Path(__file__).parents[1] / "fuzzy" / "golden_octave.npz")


@pytest.mark.parametrize("name", list(paper_sets()))
def test_octave_still_gives_the_committed_grid(name: str) -> None:
    np.testing.assert_allclose(octave_grid(name, paper_sets()[name]), GOLDEN[name], rtol=0, atol=1e-12)
