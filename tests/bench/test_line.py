"""A serial line with the wrong speed or with noise."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from greywhale_sim.line import Noise, resample

TEXT = bytes(range(256)) * 2


@given(st.binary(max_size=60), st.floats(0.97, 1.03))
def test_a_few_percent_off_is_no_harm(data: bytes, ratio: float) -> None:
    assert resample(data, 1e6, 1e6 * ratio) == data


@pytest.mark.parametrize("ratio", [0.9, 1.1, 115200 / 1e6, 1e6 / 115200, 57600 / 115200, 2.0])
def test_wrong_speed_garbles(ratio: float) -> None:
    assert resample(TEXT, 1e6, 1e6 * ratio) != TEXT


def test_noise_flips_single_bits_and_loses_bytes_reproducibly() -> None:
    noise, again = Noise(seed=7), Noise(seed=7)
    data = bytes(10_000)
    assert noise(data) == data
    assert again(data) == data
    noise.set("flip", 0.05)
    again.set("flip", 0.05)
    damaged = noise(data)
    assert damaged == again(data)
    assert len(damaged) == len(data)
    changed = [byte for byte in damaged if byte]
    assert 400 < len(changed) < 600
    assert all(byte.bit_count() == 1 for byte in changed)
    noise.set("flip", 0.0)
    noise.set("lose", 0.1)
    assert 8_800 < len(noise(data)) < 9_200
