"""A gain is told from chance as often as it says, and a wrong factor of the model does not look like one."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.adapt.gain import LEAST_GROUPS, Ratio, Scale
from greywhale.adapt.limits import ADAPTATION_LIMITS
from greywhale.base.types import Floats


def drawn(seed: int, ratio: float, count: int = 40) -> tuple[Floats, Floats]:
    """Errors of a person's stretches, which differ by decades, and predictions that miss them by 30 %."""
    random = np.random.default_rng(seed)
    expected = np.exp(random.normal(0.0, 1.2, count))
    return ratio * expected * np.exp(random.normal(0.0, 0.3, count)), expected


def outside(ratio: float, seeds: int = 400) -> float:
    """The share of seeds for which the ratio is said to be below 1 for certain."""
    return float(np.mean([Ratio.of(*drawn(seed, ratio)).within(0.02)[1] < 1.0 for seed in range(seeds)]))


def test_no_gain_is_seldom_taken_for_one() -> None:
    assert outside(1.05) <= 0.02


def test_a_gain_of_a_third_is_told_within_forty_stretches() -> None:
    assert outside(0.65) >= 0.9


def test_too_few_stretches_tell_nothing() -> None:
    enough = ADAPTATION_LIMITS.gain.group_s * LEAST_GROUPS
    above, below = drawn(1, 0.1, enough - 1)
    assert Ratio.of(above, below).within(0.0) == (0.0, np.inf)
    above, below = drawn(1, 0.1, enough)
    assert Ratio.of(above, below).within(0.0)[1] < 1.0


def test_a_factor_that_the_model_is_wrong_by_is_taken_out() -> None:
    """Joint by joint: each counts the same, however small its errors are."""
    predicted = np.exp(np.random.default_rng(2).normal(0.0, 1.0, (24, 4))) * [1e-3, 1e-4, 1e-5, 1e-3]
    measured = predicted * [2.0, 0.7, 1.0, 1.5]
    scale = Scale.of(measured, predicted)
    assert scale.factor == pytest.approx([2.0, 0.7, 1.0, 1.5], rel=0.02)
    assert scale.error == pytest.approx(np.log(2.0), rel=0.02)
    np.testing.assert_allclose(scale.expected(predicted), scale.seen(measured), rtol=0.02)
    assert scale.usual == pytest.approx(4.0, rel=0.1)
    worse = measured.copy()
    worse[:, 2] *= 2.0
    assert scale.seen(worse).sum() / scale.seen(measured).sum() == pytest.approx(1.25, rel=0.05)
