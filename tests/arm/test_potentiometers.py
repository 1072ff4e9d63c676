"""Potentiometers: the straight line, its ends, noise, faults and conversion."""

from __future__ import annotations

import math

import numpy as np
import pytest

from greywhale.arm import PotentiometerBank, Potentiometers, Wiring
from greywhale.arm.parameters import Potentiometer
from greywhale.files.arm import default_arm


def bank(**values: float) -> PotentiometerBank:
    return PotentiometerBank(joint=(Potentiometer(**values),) * 4)  # type: ignore[arg-type]


def test_volts_follow_the_angle_and_stay_on_the_track() -> None:
    pots = Potentiometers(bank())
    angles = np.radians([-150.0, 0.0, 75.0, 149.9])
    np.testing.assert_allclose(pots.millivolts(angles), [0.0, 2500.0, 3750.0, 5000 * (149.9 / 300 + 0.5)], atol=1e-9)
    np.testing.assert_array_equal(
        pots.millivolts(np.radians([-151.0, -300.0, 151.0, 400.0])), [0.0, 0.0, 5000.0, 5000.0]
    )


def test_centre_and_direction() -> None:
    pots = Potentiometers(bank(centre=0.5, direction=-1))
    np.testing.assert_allclose(
        pots.millivolts([0.5, 0.5 + math.radians(30), 0.5, 0.5]), [2500.0, 2000.0, 2500.0, 2500.0]
    )


def test_noise_has_its_size_and_independent_channels() -> None:
    noise = default_arm().follower_pots.joint[0].noise
    pots = Potentiometers(default_arm().follower_pots, seed=9)
    readings = np.array([pots.millivolts(np.zeros(4)) for _ in range(20_000)]) - 2500.0
    assert readings.std(axis=0) == pytest.approx(np.full(4, 1000 * noise), rel=0.03)
    assert np.abs(readings.mean(axis=0)).max() < 1000 * noise * 4 / math.sqrt(20_000)
    correlation = np.corrcoef(np.vstack([readings[1:].T, readings[:-1].T])) - np.eye(8)
    assert np.abs(correlation).max() < 0.035
    assert 0.0455 - 0.006 < (np.abs(readings) > 2000 * noise).mean() < 0.0455 + 0.006  # gaussian: 4.55 % beyond 2 sigma


def test_broken_wires() -> None:
    pots = Potentiometers(default_arm().leader_pots)
    pots.set_wiring(1, Wiring.OPEN)
    pots.set_wiring(2, Wiring.SHORTED)
    readings = pots.millivolts([0.3, 0.3, 0.3, 0.3])
    assert readings[1] == 0.0
    assert readings[2] == 5000.0
    assert 2700 < readings[0] < 2900
    pots.set_wiring(1, Wiring.CONNECTED)
    assert pots.millivolts([0.3] * 4)[1] > 2700
    assert pots.wiring(2) is Wiring.SHORTED
    with pytest.raises(IndexError):
        pots.set_wiring(4, Wiring.OPEN)


def test_linearity_error_vanishes_at_ends_and_centre() -> None:
    pots = Potentiometers(bank(linearity=0.01))
    angles = np.radians([[-150.0, -75.0, 0.0, 75.0]])[0]
    np.testing.assert_allclose(pots.millivolts(angles), [0.0, 1250.0 + 50.0, 2500.0, 3750.0 - 50.0], atol=1e-9)


def test_counts_are_those_of_a_10_bit_converter() -> None:
    pots = Potentiometers(bank())
    step = math.radians(300) / 1024
    angles = np.array([-math.radians(150), -0.5 * step, 0.5 * step, math.radians(150)])
    np.testing.assert_array_equal(pots.counts(angles), [0, 511, 512, 1023])
    np.testing.assert_array_equal(pots.counts(angles, bits=12)[[0, 3]], [0, 4095])
    with pytest.raises(ValueError, match="1 to 24 bits"):
        pots.counts(angles, bits=0)
