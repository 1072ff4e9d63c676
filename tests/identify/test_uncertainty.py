"""Deviations hold what the readings leave open, and what the arm file's masses and lengths may be off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import PITCH_JOINTS
from greywhale.identify.data import prepare
from greywhale.identify.limits import IDENTIFICATION_LIMITS
from greywhale.identify.space import MOTOR, Space
from greywhale.identify.uncertainty import combine_sources, uncertainty
from greywhale.identify.windows import WindowResidual
from tools.support.recordings import Recorded


def test_a_torque_is_no_surer_than_the_masses_that_it_lifts(recorded: Recorded, hidden: ArmParameters) -> None:
    """Alpha of a pitch joint follows the weight; what is measured in volts and seconds does not."""
    space = Space.of(hidden, (*MOTOR, "coulomb"), range(4))
    residual = WindowResidual([prepare(recorded.fit, 1)], hidden, range(4), every=8)
    sure = uncertainty(residual, space, space.start(), range(4), to_read=True)
    plain = uncertainty(residual, space, space.start(), range(4))
    np.testing.assert_array_equal(sure.covariance, plain.covariance)
    by_links = dict(zip(space.names, np.sqrt(np.diag(sure.besides)), strict=True))
    mass = IDENTIFICATION_LIMITS.uncertainty.mass_share / np.sqrt(3.0)
    for joint in PITCH_JOINTS:
        assert 0.5 * mass < by_links[f"joint{joint}.alpha"] < 1.5 * mass
        assert by_links[f"joint{joint}.damping"] < 0.5 * mass
    assert np.all(sure.deviations >= plain.deviations)


def test_a_gap_is_less_sure_where_play_hides_it(recorded: Recorded, hidden: ArmParameters) -> None:
    """People read that; plants that are drawn do not have it."""

    def variance(beside_play: float, *kinds: str) -> float:
        sure = replace(IDENTIFICATION_LIMITS.uncertainty, gap_beside_play_rad=beside_play)
        log = prepare(recorded.fit, 1, replace(IDENTIFICATION_LIMITS, uncertainty=sure))
        space = Space.of(hidden, kinds, (3,))
        found = uncertainty(WindowResidual([log], hidden, (3,), every=8), space, space.start(), (3,), to_read=True)
        gap = space.names.index("joint3.gap")
        return float(found.besides[gap, gap])

    assert variance(0.01, "gap", "play") == pytest.approx(variance(0.0, "gap", "play") + 1e-4)
    assert variance(0.01, "gap") == variance(0.0, "gap")


def test_friction_and_play_are_less_sure_where_a_joint_creeps(recorded: Recorded, hidden: ArmParameters) -> None:
    """Another law of creep would take its share of them; nobody knows which law an arm has."""
    space = Space.of(hidden, ("damping", "coulomb", "play", "creep"), (3,))
    shares = np.array([0.1, 0.25, 0.027, 0.0])  # of the creep
    creep = space.start()[space.names.index("joint3.creep")]

    def besides(*creeping: tuple[str, float]) -> np.ndarray:
        sure = replace(IDENTIFICATION_LIMITS.uncertainty, creeping=creeping)
        log = prepare(recorded.fit, 1, replace(IDENTIFICATION_LIMITS, uncertainty=sure))
        windows = WindowResidual([log], hidden, (3,), every=8)
        return uncertainty(windows, space, space.start(), (3,), to_read=True).besides

    wider = besides(("damping", 0.1), ("coulomb", 0.25), ("play", 0.027)) - besides()
    np.testing.assert_allclose(wider, np.diag((shares * creep) ** 2), atol=1e-12)


def test_two_numbers_of_which_only_the_sum_shows_stay_as_open_as_in_the_arm_file() -> None:
    """A driver that keeps volts in one direction alone has such numbers: the mean, and half of the difference."""
    draws = np.random.default_rng(5)
    for readings in range(100, 120):
        slopes = np.repeat(1e3 * draws.uniform(0.5, 2.0, (readings, 1)), 2, axis=1)
        gradients = slopes * draws.normal(size=(readings, 1))
        information, scatter, nominal = slopes.T @ slopes, gradients.T @ gradients, np.diag([9.0, 9.0])
        found = combine_sources(information, scatter, information, nominal)
        assert found[0, 0] + found[1, 1] - 2.0 * found[0, 1] == pytest.approx(2.0 / 9.0)
        assert 0.0 <= found.sum() < 1e-5
