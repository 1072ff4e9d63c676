"""Overshoot and settling time of steps whose answers are known by formula."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.base.types import Floats
from greywhale.measure import JointMeasures, evaluate, more_overshoot
from tests.measure.test_measure import log, log_of

TIME = np.arange(0, 8, 0.001)
DAMPING, OMEGA = 0.4, 12.0


def second_order(time: Floats, damping: float = DAMPING) -> Floats:
    """The answer of a mass on a spring to a unit step at 0."""
    after = np.maximum(time, 0.0)
    turn = OMEGA * np.sqrt(1.0 - damping**2)
    ring = np.cos(turn * after) + damping * OMEGA / turn * np.sin(turn * after)
    return np.asarray(1.0 - np.exp(-damping * OMEGA * after) * ring)


def jump(size: float, at: float = 2.0) -> Floats:
    return np.where(at <= TIME, size, 0.0)


@pytest.mark.parametrize("size", [1.0, -0.6])
def test_overshoot_and_settling_are_those_of_the_formula(size: float) -> None:
    joint = evaluate(log(TIME, jump(size), size * second_order(TIME - 2.0))).joints[0]
    assert joint.overshoot_percent == pytest.approx(100 * np.exp(-np.pi * DAMPING / np.sqrt(1 - DAMPING**2)), abs=0.3)
    fine = np.arange(0.0, 4.0, 1e-4)
    outside = fine[np.abs(second_order(fine) - 1.0) > 0.05]
    assert joint.settling_s == pytest.approx(outside[-1], abs=0.01)
    assert joint.unsettled_steps == 0


def test_of_several_steps_the_worst_counts() -> None:
    leader = jump(1.0) - jump(0.5, 5.0)
    follower = second_order(TIME - 2.0, 0.7) - 0.5 * second_order(TIME - 5.0)
    both = evaluate(log(TIME, leader, follower)).joints[0]
    alone = evaluate(log(TIME, jump(1.0), second_order(TIME - 2.0))).joints[0]
    assert both.overshoot_percent == pytest.approx(alone.overshoot_percent, abs=0.1)
    assert both.settling_s == pytest.approx(alone.settling_s, abs=0.01)


def test_a_follower_that_stays_beside_the_leaders_place_never_settles() -> None:
    joint = evaluate(log(TIME, jump(1.0), 0.9 * second_order(TIME - 2.0, 0.9))).joints[0]
    assert (joint.settling_s, joint.unsettled_steps, joint.settling(".2f")) == (None, 1, "never")
    assert joint.overshoot_percent == 0.0


def test_small_steps_settle_within_the_band_of_a_rest() -> None:
    """5 % of a small step would be less than an arm's steady-state error."""
    joint = evaluate(log(TIME, jump(0.2), 0.2 * second_order(TIME - 2.0, 0.9) - 0.015)).joints[0]
    assert joint.unsettled_steps == 0


def test_the_way_of_a_hand_is_not_counted() -> None:
    """A reach takes its time; a follower on its heels settles at once, one 0.2 s late settles that much later."""
    share = np.clip(TIME - 2.0, 0.0, 1.0)
    leader = share**3 * (10 - 15 * share + 6 * share**2)
    assert evaluate(log(TIME, leader, leader)).joints[0].settling_s == pytest.approx(0.0, abs=0.002)
    late = np.concatenate([np.zeros(200), leader[:-200]])
    assert evaluate(log(TIME, leader, late)).joints[0].settling_s == pytest.approx(0.2, abs=0.002)


def test_noise_of_a_potentiometer_is_no_overshoot() -> None:
    noise = np.random.default_rng(1).normal(0.0, 0.003, len(TIME))
    joint = evaluate(log(TIME, jump(1.0), second_order(TIME - 2.0, 0.95) + noise)).joints[0]
    assert joint.overshoot_percent is not None
    assert joint.overshoot_percent < 0.5


def test_without_a_step_into_a_rest_there_is_neither() -> None:
    for leader in (0.0 * TIME, np.sin(TIME), np.where((TIME > 2) & (TIME < 2.3), 1.0, 0.0)):
        joint = evaluate(log(TIME, leader, leader)).joints[0]
        assert (joint.overshoot_percent, joint.settling_s, joint.settling(".2f")) == (None, None, None)


def test_more_overshoot_than_before_is_named_by_joint() -> None:
    leader = np.column_stack([jump(1.0)] * 4)
    calm, brisk = second_order(TIME - 2.0, 0.9), second_order(TIME - 2.0)
    before = evaluate(log_of(TIME, leader, np.column_stack([calm, calm, brisk, calm])))
    after = evaluate(log_of(TIME, leader, np.column_stack([calm, brisk, calm, calm])))
    assert more_overshoot(before, after) == "joint 1 from 0 to 25 %"
    assert more_overshoot(before, before) == ""
    assert JointMeasures(0.1, None, None, None, 0).settling(".2f") is None
