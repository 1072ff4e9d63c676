"""A screening design tells effects from chance."""

from __future__ import annotations

import numpy as np
import pytest

from tools.support.screening import effects, screen, standard_error


@pytest.mark.parametrize("columns", [1, 6, 7, 8, 19, 22, 37, 53])
def test_the_columns_of_a_design_are_balanced_and_orthogonal(columns: int) -> None:
    design = screen(columns)
    np.testing.assert_array_equal(design.sum(axis=0), 0)
    np.testing.assert_array_equal(design.T @ design, len(design) * np.eye(columns))


def test_an_effect_stands_out_from_chance_and_nothing_does_not() -> None:
    random = np.random.default_rng(1)
    design, true = screen(31), np.zeros(31)
    true[[3, 20]] = 1.0, -0.5
    response = 7.0 + design @ (0.5 * true) + random.normal(0.0, 0.1, len(design))
    found = effects(design, response)
    error = standard_error(found, len(design), random.normal(0.0, 0.1, 8))
    np.testing.assert_allclose(found, true, atol=0.15)
    assert error == pytest.approx(2.0 * 0.1 / np.sqrt(32), rel=0.5)
    assert set(np.flatnonzero(np.abs(found) > 4.0 * error)) == {3, 20}
