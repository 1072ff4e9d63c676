"""Long lines are drawn with fewer points, and look alike."""

from __future__ import annotations

import numpy as np

from greywhale.pictures.thinning import thin


def test_a_long_line_keeps_every_peak_and_its_order() -> None:
    time = np.arange(1_234_567) / 1000.0
    values = np.sin(time)
    values[[7, 700_001, 1_234_560]] = 3.0, -4.0, 5.0
    less, shown = thin(time, values)
    assert len(less) < 25_000
    assert (np.diff(less) >= 0.0).all()
    np.testing.assert_array_equal(shown, values[np.searchsorted(time, less)])
    for begin in range(0, len(time), 50_000):
        within = (less >= time[begin]) & (less <= time[min(begin + 49_999, len(time) - 1)])
        np.testing.assert_allclose(np.ptp(shown[within]), np.ptp(values[begin : begin + 50_000]), rtol=1e-3)


def test_a_usual_line_is_as_it_is() -> None:
    time, values = np.arange(60_000) / 1000.0, np.random.default_rng(1).normal(size=60_000)
    assert thin(time, values) == (time, values)
