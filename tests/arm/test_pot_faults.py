"""Faulty potentiometers: each shows its fault, and the others none."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm import PotFault, PotFaults


def shown(faults: PotFaults, pot: int, path: np.ndarray) -> np.ndarray:
    rows = []
    for millivolts in path:
        row = 100.0 * np.arange(1.0, 9.0)
        row[pot] = millivolts
        faults.apply(row)
        rows.append(row)
    return np.array(rows)


def test_a_frozen_one_stays_and_the_others_go_on() -> None:
    faults = PotFaults()
    faults.inject(2, PotFault.FROZEN)
    rows = shown(faults, 2, np.linspace(1000.0, 3000.0, 50))
    assert set(rows[:, 2]) == {1000.0}
    assert rows[:, 3] == pytest.approx(400.0)


def test_a_slipping_one_loses_its_share_of_every_way_up_and_none_to_noise() -> None:
    faults = PotFaults()
    faults.inject(6, PotFault.SLIPPING)
    way = np.concatenate([np.arange(1000.0, 3001.0, 50.0), np.arange(2950.0, 999.0, -50.0)])
    rows = shown(faults, 6, way)
    assert rows[40, 6] == pytest.approx(1000.0 + 2000.0 * 0.7)
    assert rows[-1, 6] == pytest.approx(1000.0 - 2000.0 * 0.3)
    noise = np.random.default_rng(1).normal(rows[-1, 6] + 600.0, 3.0, 5000)
    noisy = shown(faults, 6, noise)
    assert np.ptp(noisy[100:, 6]) < 40.0, "noise alone does not move it away"


def test_a_loose_one_is_off_now_and_then() -> None:
    faults = PotFaults()
    faults.inject(0, PotFault.LOOSE)
    rows = shown(faults, 0, np.full(2 * 920, 2500.0))  # 230 ms, twice
    assert np.count_nonzero(rows[:, 0] == 0.0) == 2 * 8
    assert set(rows[:, 0]) == {0.0, 2500.0}


def test_a_noisy_one_is_off_by_a_tenth_of_a_volt_and_a_humming_one_with_the_mains() -> None:
    faults = PotFaults()
    faults.inject(3, PotFault.NOISY)
    faults.inject(5, PotFault.HUMMING)
    rows = shown(faults, 3, np.full(8000, 2500.0))  # 2 s
    assert np.std(rows[:, 3]) == pytest.approx(100.0, rel=0.03)
    hum = np.fft.rfft(rows[:, 5] - 600.0) / 4000.0
    assert np.argmax(np.abs(hum)) == 2 * 50
    assert np.abs(hum[100]) == pytest.approx(25.0)


def test_a_mended_potentiometer_shows_its_angle_again() -> None:
    faults = PotFaults()
    faults.inject(7, PotFault.REVERSED)
    assert shown(faults, 7, np.array([1000.0]))[0, 7] == 4000.0
    faults.inject(7, None)
    assert not faults.any
    with pytest.raises(IndexError):
        faults.inject(8, PotFault.REVERSED)


def test_swapped_wires_exchange_two_readings() -> None:
    faults = PotFaults()
    faults.swap(1, 6)
    row = np.arange(8.0)
    faults.apply(row)
    assert row.tolist() == [0, 6, 2, 3, 4, 5, 1, 7]
