"""The known controllers, beside their recurrences written out as the boards run them."""

from __future__ import annotations

import numpy as np
import pytest

from studies.one_joint.law import Law, proportional, proportional_derivative, proportional_resonant, trapezoidal_pid

ROWS = 400
PERIOD = 2e-3


@pytest.fixture
def signals() -> tuple[np.ndarray, np.ndarray]:
    time = PERIOD * np.arange(ROWS)
    return np.sign(np.sin(9 * time)), 0.8 * np.sin(8 * time - 0.3)


def test_the_pid_is_the_trapezoidal_rule_with_its_integral_running_on_at_the_limit(
    signals: tuple[np.ndarray, np.ndarray],
) -> None:
    leader, follower = signals
    kp, ki, kd, pole, limit = 3.0, 5.0, 0.4, 20.0, 2.5
    integral, before, slope = 0.7, 0.0, 0.0
    expected = []
    for e in leader - follower:
        integral += ki * PERIOD * (e + before) / 2
        slope = slope * (2 - pole * PERIOD) / (2 + pole * PERIOD) + 2 * pole * kd / (2 + pole * PERIOD) * (e - before)
        expected.append(min(max(kp * e + integral + slope, -limit), limit))
        before = e
    law = trapezoidal_pid(kp, ki, kd, pole, PERIOD, limit, integral=0.7)
    assert np.max(np.abs(np.array(expected))) == limit
    np.testing.assert_allclose(law.output(leader, follower), expected, atol=1e-12)


def test_the_resonator_rings_as_its_recurrence_does(signals: tuple[np.ndarray, np.ndarray]) -> None:
    leader, follower = signals
    kp, kr, omega = 2.0, 40.0, 12.0
    square = (omega * PERIOD) ** 2
    lead, back = (float(np.float32(one)) for one in (2 * kr * PERIOD / (4 + square), (2 * square - 8) / (4 + square)))
    e1 = e2 = u1 = u2 = 0.0
    expected = []
    for e in leader - follower:
        u = lead * e - lead * e2 - back * u1 - u2
        expected.append(kp * e + u)
        e1, e2, u1, u2 = e, e1, u, u1
    law = proportional_resonant(kp, kr, omega, PERIOD, limit=1e9)
    np.testing.assert_allclose(law.output(leader, follower), expected, rtol=1e-9, atol=1e-9)


def test_a_derivative_does_not_kick_at_the_first_row(signals: tuple[np.ndarray, np.ndarray]) -> None:
    leader, follower = signals
    e = leader + 1.0 - follower
    law = proportional_derivative(2.0, 0.1, limit=1e9, period=PERIOD)
    expected = 2.0 * e + 0.1 * np.diff(e, prepend=e[0]) / PERIOD
    np.testing.assert_allclose(law.output(leader + 1.0, follower), expected, atol=1e-9)


def test_states_come_from_a_law_that_runs_several_times_a_row(signals: tuple[np.ndarray, np.ndarray]) -> None:
    leader, follower = signals
    once, often = (_integrator(PERIOD / n, n) for n in (1, 4))
    # An integrator of straight lines gathers the same however often it runs, but for what lies within a row.
    difference = often.states(leader, follower) - once.states(leader, follower)
    assert np.max(np.abs(difference)) < PERIOD * 2.0
    assert often.states(leader, follower).shape == (ROWS, 1)


def test_a_proportional_law_is_cut_at_its_limit() -> None:
    law = proportional(10.0, limit=7.0)
    np.testing.assert_array_equal(law.output(np.array([0.1, 1.0, -1.0]), np.zeros(3)), [1.0, 7.0, -7.0])


def _integrator(period: float, steps: int) -> Law:
    one = np.ones((1, 1))
    return Law(one, period * np.array([[1.0, -1.0]]), np.ones(1), np.zeros(2), 1e9, steps_per_row=steps, start=(0.0,))
