"""Writes tests/fuzzy/golden_octave.npz, Octave's grids for every set of the paper, so that `make test` needs no Octave.

python tests/oracles/write_fuzzy_golden.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from fuzzy_octave import octave_grid, paper_sets

TARGET = Path(__file__).parents[1] / "fuzzy" / "golden_octave.npz"


def main() -> None:
    grids = {name: octave_grid(name, sets) for name, sets in paper_sets().items()}
    np.savez_compressed(TARGET, **grids)
    print(f"{TARGET}: {len(grids)} grids, {TARGET.stat().st_size} bytes")


if __name__ == "__main__":
    main()
