"""Identification of one joint finds the plants of made-up records, and the lags that it must beat find theirs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.identify.fit import Fit
from studies.one_joint import fit
from studies.one_joint.fit import Example, JointModel, fit_joint, identify_joint
from studies.one_joint.law import proportional
from studies.one_joint.loop import Runner
from studies.one_joint.naive import Lag, fit_lag
from studies.one_joint.plant import JointSpace, Rig, plants
from studies.one_joint.record import Record, pieces_of
from studies.one_joint.residual import Part, left_out
from tests.studies.one_joint.records import made, still

SERVO = Rig("servo", 7.4, alpha=9.0, inertia=0.03, damping=0.3, link_inertia=0.005, weight=0.48, zero_known=True)
TRUE = {"alpha": 11.0, "inertia": 0.018, "damping": 0.45, "coulomb": 0.12, "load_friction": 0.35}
YAW = Rig("yaw", 12.0, inertia=0.5, damping=3.0)


def led(seconds: float) -> Record:
    record = still(seconds, period=5e-3)
    time = record.time
    return replace(record, leader=1.1 * np.sin(2.1 * time) + 0.5 * np.sin(5.3 * time), leader_lines=True)


def plant(rig: Rig, **values: float) -> np.ndarray:
    return plants(rig, {name: np.array([value]) for name, value in values.items()})


@pytest.fixture(scope="module")
def swings() -> Record:
    return made(led(8.0), proportional(4.0, 7.4), plant(SERVO, **TRUE), noise=1e-3)


@pytest.fixture(scope="module")
def model(swings: Record) -> JointModel:
    """Fitted to their first half."""
    return fit_joint(SERVO, [Example(swings, proportional(4.0, 7.4), 0, swings.middle)], tuple(TRUE))


@pytest.mark.slow
def test_a_fit_finds_motor_and_load_friction_of_a_servo_that_swings_a_weight(swings: Record, model: JointModel) -> None:
    law = proportional(4.0, 7.4)
    for name, value in model.values.items():
        assert value == pytest.approx(TRUE[name], rel=0.15), name
    lag = fit_lag([swings.until(swings.middle)], 2)
    later = slice(swings.middle, None)
    run = Runner(swings, law).run(model.plant, pieces_of(swings, 0, len(swings.time)))
    physics = np.sqrt(np.mean((run.angles[0, 0] - swings.follower)[later] ** 2))
    naive = np.sqrt(np.mean((lag.follow(swings) - swings.follower)[later] ** 2))
    assert physics < 0.004
    assert naive > 10.0 * physics


@pytest.mark.slow
def test_a_model_holds_in_a_controller_that_it_was_not_fitted_in(model: JointModel) -> None:
    stiff = proportional(12.0, 7.4)
    other = made(led(4.0), stiff, plant(SERVO, **TRUE))
    assert np.sqrt(np.mean(Runner(other, stiff).errors(model.plant, pieces_of(other, 0, 800)) ** 2)) < 0.01


@pytest.mark.slow
def test_identification_adds_what_the_record_shows_and_nothing_else(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fit, "GLOBAL_EVALUATIONS", 60)
    law = proportional(15.0, 12.0)
    record = made(led(4.0), law, plant(YAW, inertia=0.3, damping=4.0, coulomb=0.8, pull=0.1), noise=1e-3)
    told: list[tuple[str, float]] = []
    model = identify_joint(YAW, [Example(record, law)], report=lambda what, share: told.append((what, share)))
    assert "pull" in model.space.names
    assert "load_friction" not in model.space.names
    assert model.values["pull"] == pytest.approx(0.1, abs=0.02)
    assert model.values["coulomb"] == pytest.approx(0.8, rel=0.1)
    assert model.tried[0] == (("inertia", "damping", "coulomb"), 1.0)
    assert all(0.0 <= share <= 1.0 for _, share in told)


def test_without_a_known_controller_the_logged_voltages_do() -> None:
    record = made(led(6.0), proportional(15.0, 12.0), plant(YAW, inertia=0.3, damping=4.0, coulomb=0.8), noise=5e-4)
    values = fit_joint(YAW, [Example(record, None)], ("inertia", "damping", "coulomb")).values
    assert values == pytest.approx({"inertia": 0.3, "damping": 4.0, "coulomb": 0.8}, rel=0.1)


def test_a_block_that_is_left_out_is_predicted_as_a_fit_to_the_others_would() -> None:
    random = np.random.default_rng(3)
    space = JointSpace.of(YAW, ("inertia", "damping"))
    blocks = np.repeat([0, 1, 2], 20)
    rows = random.standard_normal((60, 2))
    readings = rows @ np.array([0.2, -0.1]) + 0.1 * random.standard_normal(60)
    prior = np.eye(2)
    # Numbers count from the rig's published ones, which the prior pulls to.
    jacobian = np.vstack([rows, prior])
    best = np.linalg.lstsq(jacobian, np.concatenate([readings, np.zeros(2)]), rcond=None)[0]
    found = Fit(
        space, space.start() + best, 0.0, jacobian @ best - np.concatenate([readings, np.zeros(2)]), jacobian, 0
    )
    part = Part(Runner(led(1.0), None), pieces_of(led(1.0), 0, 20), 1, 0.5, blocks)
    expected = []
    for block in range(3):
        others = np.vstack([rows[blocks != block], prior])
        known = np.concatenate([readings[blocks != block], np.zeros(2)])
        refit = np.linalg.lstsq(others, known, rcond=None)[0]
        expected.append(rows[blocks == block] @ refit - readings[blocks == block])
    scale = 0.5 / 0.02
    np.testing.assert_allclose(left_out(found, [part], [0.02]), [np.mean(np.square(expected)) / scale**2])


def test_a_joint_that_rests_is_refused() -> None:
    with pytest.raises(UserError, match="the joint rests in every record"):
        identify_joint(YAW, [Example(still(2.0), None)])
    with pytest.raises(UserError, match="at least one record"):
        identify_joint(YAW, [])


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
