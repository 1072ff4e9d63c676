"""The lags that physics must beat are themselves fitted as well as can be: they find what made their own data."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from studies.one_joint import Lag, Record, fit_lag
from tests.studies.one_joint.records import still

FIRST = Lag(1, gain=0.8, offset=0.05, dead_time=0.04, shape=(0.12,))
SECOND = Lag(2, gain=0.9, offset=-0.02, dead_time=0.025, shape=(9.0, 0.4))


def led_by_steps() -> Record:
    record = still(6.0, period=5e-3)
    return replace(record, leader=np.sign(np.sin(2.0 * record.time + 0.1)) + 0.3 * np.sin(7.0 * record.time))


@pytest.mark.slow
@pytest.mark.parametrize("lag", [FIRST, SECOND])
def test_a_fit_finds_the_lag_that_made_the_record(lag: Lag) -> None:
    record = led_by_steps()
    made = replace(record, follower=lag.follow(record))
    found = fit_lag([made.until(made.middle)], lag.order)
    assert np.max(np.abs(found.follow(made) - made.follower)) < 0.01
    assert found.gain == pytest.approx(lag.gain, rel=0.02)
    assert found.dead_time == pytest.approx(lag.dead_time, abs=3e-3)
    assert found.shape == pytest.approx(lag.shape, rel=0.05)


def test_a_first_order_lag_answers_a_step_as_its_formula() -> None:
    record = still(1.0, leader=1.0, angle=0.05)
    later = np.maximum(record.time - FIRST.dead_time, 0.0)
    np.testing.assert_allclose(FIRST.follow(record), 0.05 + 0.8 * -np.expm1(-later / 0.12), atol=0.01)
