"""Records, and the native simulation of one joint, beside scipy's integrator, closed forms and the arm's own plant."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from greywhale.arm import Arm
from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.files.arm import default_arm
from greywhale.simulate import PLANT_COLUMNS, plant_row
from studies.one_joint.law import Law, proportional, relay, trapezoidal_pid
from studies.one_joint.loop import Runner
from studies.one_joint.plant import COLUMNS, Rig, plants
from studies.one_joint.record import Record, pieces_of
from tests.studies.one_joint.records import still

PENDULUM = Rig("pendulum", supply=7.4, alpha=10.0, inertia=0.02, damping=0.4, link_inertia=0.005, weight=0.48)
SLIDER = Rig("slider", supply=12.0, inertia=0.5, damping=2.0)


def plant_of(rig: Rig, **values: float) -> Floats:
    return plants(rig, {name: np.array([value]) for name, value in values.items()})


def angles(record: Record, plant: Floats, law: Law | None = None) -> Floats:
    moved: Floats = Runner(record, law).run(plant, pieces_of(record, 0, len(record.time))).angles[0, 0]
    return moved


def test_a_pendulum_in_a_pid_moves_as_scipy_integrates_it() -> None:
    period, rows = 2e-3, 750
    time = np.asarray(period * np.arange(rows), dtype=np.float64)
    leader = 0.9 * np.sign(np.sin(5.0 * time + 0.1))
    zero = np.zeros(rows)
    record = Record("pid", time, leader, zero, zero, zero, False, False)
    limit = PENDULUM.supply
    law = trapezoidal_pid(9.0, 12.0, 0.3, 40.0, period, limit, integral=0.5)
    plant = plant_of(PENDULUM, hanging=0.05)

    def slope(_: float, state: np.ndarray, volts: float) -> list[float]:
        torque = (volts - PENDULUM.damping * state[1]) / PENDULUM.alpha
        inertia = PENDULUM.link_inertia + PENDULUM.inertia / PENDULUM.alpha
        return [state[1], (torque - PENDULUM.weight * math.sin(state[0] - 0.05)) / inertia]

    x, state, expected = np.array([0.5, 0.0, 0.0]), np.zeros(2), []
    for row in range(rows):
        expected.append(state[0])
        signals = np.array([leader[row], state[0]])
        volts = float(np.clip(law.c @ x + law.d @ signals, -limit, limit))
        x = law.a @ x + law.b @ signals
        state = solve_ivp(slope, (0.0, period), state, args=(volts,), rtol=1e-9, atol=1e-11).y[:, -1]
    coarse = angles(record, plant, law) - expected
    # First order in its step: 1 ms here, and a fifth of that below.
    fine = _finer(record, law, plant, 5) - expected
    assert np.ptp(expected) > 1.5
    assert np.max(np.abs(coarse)) < 0.02
    assert np.max(np.abs(fine)) < 0.3 * np.max(np.abs(coarse))


def _finer(record: Record, law: Law, plant: Floats, times: int) -> Floats:
    """The same run in steps so many times shorter, by giving the record more rows and the law fewer moments."""
    runner = Runner(record, law)
    runner.substeps *= times
    moved: Floats = runner.run(plant, pieces_of(record, 0, len(record.time))).angles[0, 0]
    return moved


@pytest.mark.parametrize(("share", "moves"), [(0.55, True), (0.65, False), (1.35, False), (1.45, True)])
def test_a_gear_with_load_friction_holds_a_weight_between_lowering_and_lifting_it(share: float, moves: bool) -> None:
    angle = 0.8
    balance = PENDULUM.weight * math.sin(angle) * PENDULUM.alpha
    plant = plant_of(PENDULUM, coulomb=1e-3, load_friction=0.4)
    record = still(0.3, volts=share * balance, angle=angle)
    assert (np.ptp(angles(record, plant)) > 1e-3) == moves


def test_a_voltage_acts_its_delay_later_also_between_two_rows() -> None:
    plant, late = plant_of(SLIDER), plant_of(SLIDER, delay=0.0254)
    record = still(1.0)
    record.volts[100:] = 5.0
    now, then = angles(record, plant), angles(record, late)
    expected = np.interp(record.time - 0.0254, record.time, now)
    np.testing.assert_allclose(then, expected, atol=2e-5)
    assert then[110] == 0.0


def test_a_leader_is_seen_its_delay_later_in_the_loop() -> None:
    law = proportional(20.0, limit=12.0)
    record = still(1.0)
    record.leader[200:] = 1.0
    seen = angles(record, plant_of(SLIDER, leader_delay=0.05), law)
    np.testing.assert_allclose(seen[50:], angles(record, plant_of(SLIDER), law)[:-50], atol=1e-12)


def test_a_relay_gives_its_limit_to_either_side_and_cycles() -> None:
    record = still(3.0, leader=1.0)
    run = Runner(record, relay(limit=6.0, hysteresis=0.05)).run(plant_of(SLIDER), pieces_of(record, 0, 3000))
    assert set(np.unique(run.volts)) == {-6.0, 6.0}
    last = run.angles[0, 0, 2000:]
    assert last.max() > 1.05
    assert last.min() < 0.95


def test_readings_come_in_steps_of_the_converter() -> None:
    record = replace(still(0.2, leader=0.05), resolution=0.2)
    run = Runner(record, proportional(10.0, limit=12.0)).run(plant_of(SLIDER), pieces_of(record, 0, 200))
    # The joint moves within its first step, which the controller reads as 0 all along.
    assert run.angles[0, 0, -1] > 0.0
    np.testing.assert_allclose(run.volts, 0.5)


def test_the_joint_is_the_arms_own_with_friction_gear_and_all() -> None:
    arm = default_arm()
    dust = {"mass": 1e-9, "length": 1e-3, "centre": 0.0, "inertia": {"xx": 1e-12, "yy": 1e-12, "zz": 1e-12}}
    link = {"mass": 0.2, "length": 0.1, "centre": 0.05, "inertia": {"xx": 1e-3, "yy": 1e-3, "zz": 1e-3}}
    content = arm.model_dump() | {"link": (link, dust, dust, dust), "tip": {"mass": 0.0}}
    # Without a gap, as the arm's seed would place its motor elsewhere in it; the teeth stay.
    content["joint"][0]["gear"]["half_gap"] = 0.0
    arm = type(arm).model_validate(content)
    values = dict(zip(PLANT_COLUMNS, plant_row(arm), strict=True))
    own = {"link_inertia": 1e-3}
    row = np.array([[own.get(name, values.get(f"joint0.{name}", 0.0)) for name in COLUMNS]])
    assert values["joint0.stiffness"] > 0.0
    record = still(2.0)
    record.volts[:] = 9.0 * np.sin(4.0 * record.time**2)
    whole = Arm(arm, longest_step=1e-3)
    runner = Runner(record, None)
    runner.substeps = 1
    found = runner.run(row, pieces_of(record, 0, len(record.time))).angles[0, 0]
    expected = [0.0, *(whole.step([volts, 0.0, 0.0, 0.0], 1e-3)[0] for volts in record.volts[:-1])]
    assert np.ptp(expected) > 0.5
    np.testing.assert_allclose(found, expected, atol=1e-6)
    assert whole.unsettled_steps == 0


def test_what_does_not_fit_together_is_refused() -> None:
    record = still(0.2)
    runner = Runner(record, None)
    pieces = pieces_of(record, 0, 200)
    with pytest.raises(ValueError, match="a plant has 19 columns"):
        runner.run(np.zeros((1, 18)), pieces)
    with pytest.raises(ValueError, match="a window reaches beyond the record"):
        runner.run(plant_of(SLIDER), replace(pieces, rows=201))


def parabola() -> Record:
    record = still(1.0)
    return replace(record, follower=0.2 + 0.5 * record.time - 3.0 * record.time**2)


def test_a_piece_starts_at_the_angle_and_speed_that_the_rows_before_it_say() -> None:
    record = parabola()
    later = record.follower.copy()
    later[401:] = 9.0
    for known in (record, replace(record, follower=later)):
        angle, speed = known.start(400)
        assert angle == pytest.approx(record.follower[400], abs=1e-9)
        assert speed == pytest.approx(0.5 - 6.0 * record.time[400], abs=1e-6)


def test_coarse_readings_are_smoothed_over_longer() -> None:
    step = 0.06
    record = still(2.0)
    true = 0.4 * record.time
    coarse = replace(record, follower=step * np.floor(true / step + 0.5), resolution=step)
    starts = np.array([coarse.start(row) for row in range(500, 2000, 50)])
    assert np.std(starts[:, 0] - true[500:2000:50]) < 0.5 * step
    assert np.std(starts[:, 1] - 0.4) < 0.3


def test_pieces_cover_their_part_of_the_record_and_no_more() -> None:
    pieces = pieces_of(parabola(), 300, 950, 0.2)
    assert pieces.first.tolist() == [300, 500, 700]
    assert pieces.rows == 200
    whole = pieces_of(parabola(), 300, 950)
    assert (whole.first.tolist(), whole.rows) == ([300], 650)


def test_the_middle_is_that_of_time() -> None:
    record = still(1.0)
    warped = replace(record, time=record.time**2 + record.time)
    assert warped.time[warped.middle] == pytest.approx(0.5 * warped.time[-1], rel=0.01)
    assert len(warped.until(warped.middle).time) == warped.middle


def test_what_is_no_record_is_refused_by_name() -> None:
    record = still(1.0)
    with pytest.raises(UserError, match="still: volts must hold a finite number for each of 1000 rows"):
        replace(record, volts=np.full(1000, np.nan))
    with pytest.raises(UserError, match="still: at least 20 rows with rising times"):
        replace(record, time=record.time[::-1])
