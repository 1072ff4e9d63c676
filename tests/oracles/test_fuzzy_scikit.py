"""scikit-fuzzy, an implementation of others in another language: memberships, rules and the 101-sample centroid."""

from __future__ import annotations

import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import skfuzzy

sys.path.insert(0, str(Path(__file__).parent))
from fuzzy_octave import paper_sets

from greywhale.fuzzy import exact
from greywhale.fuzzy.export_fis import OUTPUT_HALF_WIDTH

END = 1.0 + OUTPUT_HALF_WIDTH
UNIVERSE = np.linspace(-END, END, 101)


def degrees(x: float, n_c: float, z_a: float, z_c: float, p_b: float) -> tuple[float, float, float]:
    at = np.array([x])
    return (
        float(skfuzzy.trapmf(at, [-1, -1, n_c, 0])[0]),
        float(skfuzzy.trimf(at, [z_a, 0, z_c])[0]),
        float(skfuzzy.trapmf(at, [0, p_b, 1, 1])[0]),
    )


def scikit_u(x: float, y: float, s: dict[str, float]) -> float:
    ne, ze, pe = degrees(x, s["ne_c"], s["ze_a"], s["ze_c"], s["pe_b"])
    nce, zce, pce = degrees(y, s["nce_c"], s["zce_a"], s["zce_c"], s["pce_b"])
    rules = [  # Table 6, written out once more
        (min(ne, nce), -1), (min(ne, zce), -1), (min(ne, pce), 0),
        (min(ze, nce), -1), (min(ze, zce), 0), (min(ze, pce), 1),
        (min(pe, nce), 0), (min(pe, zce), 1), (min(pe, pce), 1),
    ]  # fmt: skip
    total = np.zeros_like(UNIVERSE)
    for strength, peak in rules:
        output = skfuzzy.trimf(UNIVERSE, [peak - OUTPUT_HALF_WIDTH, peak, peak + OUTPUT_HALF_WIDTH])
        total = np.fmax(total, strength * output)
    # The centroid of samples, as evalfis takes it; skfuzzy.defuzz would integrate the polygon between them.
    return float((total * UNIVERSE).sum() / total.sum())


@pytest.mark.parametrize("name", list(paper_sets()))
def test_scikit_fuzzy_agrees_with_the_exact_law(name: str) -> None:
    sets = paper_sets()[name]
    exactly = {key: Fraction(value) for key, value in sets.items()}
    for i in range(-20, 21):
        for j in range(-20, 21):
            ours = exact.infer(Fraction(i, 20), Fraction(j, 20), exactly).u
            assert scikit_u(i / 20, j / 20, sets) == pytest.approx(float(ours), abs=1e-9)
