"""What a covariance says: it covers what fits of simulated logs are off, and names what only combinations tell."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.base.types import Floats
from greywhale.files.arm import load_arm
from greywhale.identify.bootstrap import read_motion, spread_covariance
from greywhale.identify.combinations import combinations
from greywhale.identify.limits import IDENTIFICATION_LIMITS
from greywhale.identify.space import MOTOR, Space
from greywhale.protocol.firmware import ANGLE_LSB

# Of these kinds, fits of known arms were off no more than the scatter shows.
SPACE = Space.of(load_arm("default"), ("load", "creep"), range(4))
UNIT = 1e-5  # far below what the arm file leaves open
FORMULA = np.diag(np.full(len(SPACE), UNIT**2))

LIMITS = IDENTIFICATION_LIMITS.uncertainty


def scatter(size: float, logs: int = 6) -> Floats:
    found: Floats = size * np.random.default_rng(1).standard_normal((logs, len(SPACE)))
    return found


def test_without_logs_the_formula_stays() -> None:
    np.testing.assert_array_equal(spread_covariance(FORMULA, np.zeros((0, len(SPACE))), SPACE, SPACE.start()), FORMULA)


@pytest.mark.parametrize("times", [0.2, 1.0, 10.0, 100.0])
def test_deviations_grow_with_the_scatter_and_never_fall_far_below_the_formula(times: float) -> None:
    found = spread_covariance(FORMULA, scatter(times * UNIT), SPACE, SPACE.start())
    assert np.linalg.eigvalsh(found)[0] > 0.0
    np.testing.assert_allclose(found, found.T)
    deviations = np.sqrt(np.diag(found)) / UNIT
    expected = np.sqrt(LIMITS.widened * 9 / 7 * (3 * max(1.0, times**2) + 6 * times**2) / 9)
    assert np.median(deviations) == pytest.approx(expected, rel=0.3)
    assert deviations.min() > 0.5


def test_one_bad_group_does_not_widen_the_others() -> None:
    off = scatter(UNIT)
    off[:, :2] *= 50.0  # joint 0 alone
    deviations = np.sqrt(np.diag(spread_covariance(FORMULA, off, SPACE, SPACE.start()))) / UNIT
    assert deviations[:2].min() > 15.0
    assert deviations[2:].max() < 3.0


def test_bias_counts_like_scatter() -> None:
    biased = np.tile(np.full(len(SPACE), 5 * UNIT), (6, 1))
    assert (np.sqrt(np.diag(spread_covariance(FORMULA, biased, SPACE, SPACE.start()))) > 3 * UNIT).all()


def test_numbers_with_several_optima_are_never_more_certain_than_fits_of_known_arms() -> None:
    space = Space.of(load_arm("default"), (*MOTOR, "coulomb", "gap", "drag", "teeth"), range(4))
    found = spread_covariance(1e-10 * np.eye(len(space)), np.full((6, len(space)), 1e-9), space, space.start())
    for index, one in enumerate(space.parameters):
        least = min(
            dict(LIMITS.systematic).get(one.kind, 0.0), 0.7 * space.doubts()[index]
        )  # the arm file's doubt counts too
        assert np.sqrt(found[index, index]) >= 0.8 * least
    roll, yaw, pitch = (space.names.index(f"joint{joint}.alpha") for joint in (3, 0, 1))
    assert found[roll, roll] > found[yaw, yaw] > found[pitch, pitch]


def test_no_number_is_less_certain_than_the_users_arm() -> None:
    found = spread_covariance(FORMULA, scatter(100.0), SPACE, SPACE.start())
    assert (np.sqrt(np.diag(found)) <= SPACE.doubts()).all()


def test_an_arm_file_that_was_far_off_does_not_vouch_for_what_the_logs_leave_open() -> None:
    x = SPACE.start() + 4.0 * SPACE.doubts() * (np.arange(len(SPACE)) == 2)
    deviations = np.sqrt(np.diag(spread_covariance(FORMULA, scatter(100.0), SPACE, x))) / SPACE.doubts()
    assert deviations[2] == pytest.approx(4.0, rel=0.1)
    assert np.delete(deviations, 2).max() <= 1.0


def test_readings_are_those_of_a_noisy_converter_and_a_filter() -> None:
    """A slow ramp comes back late by the filter and half a tick; whole steps of 1/4096 rad; as noisy as four means."""
    ramp = np.tile(np.linspace(0.0, 1.0, 20_000)[:, None], (1, 4))
    seen = read_motion(ramp, np.full(4, 2.5e-3), 1, np.random.default_rng(2))
    np.testing.assert_array_equal(seen, np.round(seen / ANGLE_LSB) * ANGLE_LSB)
    error = (seen - ramp)[1000:]
    late = 1e-3 / 20.0 / 1e-3 * (0.6 + 1.0) * 1e-3
    assert np.abs(error.mean(axis=0) + late).max() < 3e-4
    assert error.std(axis=0) == pytest.approx(np.full(4, 2.9e-3 / 2.0 / np.sqrt(3.0)), rel=0.25)


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
