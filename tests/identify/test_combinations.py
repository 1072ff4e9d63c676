"""Combinations that logs determine are stated where single numbers lie on a ridge, and only there."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.identify.combinations import combinations
from greywhale.identify.space import MOTOR, Space

ALPHA, INERTIA = 0, 1  # of joint 0


def covariance_with_ridge(size: int, sign: float) -> np.ndarray:
    """Joint 0's alpha and inertia are known to 50 % each; their quotient (sign 1) or product (-1) to a per cent."""
    covariance = 1e-4 * np.eye(size)
    covariance[ALPHA, ALPHA] = covariance[INERTIA, INERTIA] = 0.25
    covariance[ALPHA, INERTIA] = covariance[INERTIA, ALPHA] = sign * (0.25 - 0.5e-4)
    return covariance


@pytest.mark.parametrize(
    ("sign", "name"), [(1.0, "joint0.inertia / joint0.alpha"), (-1.0, "joint0.alpha x joint0.inertia")]
)
def test_ridge_is_stated_as_what_is_known(white_box: ArmParameters, sign: float, name: str) -> None:
    space = Space.of(white_box, MOTOR, range(4))
    x = space.start()
    (found,) = combinations(space, x, covariance_with_ridge(len(space), sign))
    assert found.name == name
    values = space.values(x)
    expected = values[INERTIA] / values[ALPHA] if sign > 0 else values[INERTIA] * values[ALPHA]
    assert found.value == pytest.approx(expected)
    assert found.deviation == pytest.approx(0.01, rel=1e-6)


def test_certain_or_independent_numbers_need_no_combination(white_box: ArmParameters) -> None:
    space = Space.of(white_box, MOTOR, range(4))
    independent = np.eye(len(space))
    assert combinations(space, space.start(), independent) == ()
    assert combinations(space, space.start(), 1e-3 * covariance_with_ridge(len(space), 1.0)) == ()
