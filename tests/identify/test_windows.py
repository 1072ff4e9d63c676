"""The native window simulation against the arm itself, and the residual made of it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greywhale import _native
from greywhale.arm import Arm, ArmParameters
from greywhale.arm.body import Body
from greywhale.arm.plants import columns
from greywhale.files.arm import default_arm
from greywhale.identify.data import first_rows, prepare, some_windows, windows_of
from greywhale.identify.limits import IDENTIFICATION_LIMITS
from greywhale.identify.space import MOTOR, Space
from greywhale.identify.steps import WindowFit
from greywhale.identify.windows import WindowResidual, take_off_starts
from greywhale.loop import plant_row
from tools.support.recordings import Recorded

H = 0.25e-3
ROWS, SUBSTEPS = 50, 4


def arguments(parameters: ArmParameters, count: int = 3) -> dict[str, Any]:
    """Three windows from rest, driven by the same noise; rows come at uneven times."""
    random = np.random.default_rng(5)
    plants = np.tile(plant_row(parameters), (count, 1))
    return {
        "plants": plants,
        "offsets": np.zeros((count, 4)),
        "first": np.array([0, 50, 100], dtype=np.int64),
        "angles": np.array([[0.1, 0.2, -0.3, 0.4], [0.0, 0.0, 0.0, 0.0], [-1.0, 0.5, 0.5, 1.0]]),
        "velocities": np.zeros((3, 4)),
        "sides": np.zeros((3, 4)),
        "places": np.zeros((3, 4)),
        "rows": ROWS,
        "volts": random.uniform(-15, 15, (150 * SUBSTEPS, 4)),
        "spacing": H * SUBSTEPS * random.uniform(0.5, 1.0, 150),
        "substeps": SUBSTEPS,
        "every": 1,
    }


def test_windows_are_the_arm_bit_by_bit(white_box: ArmParameters) -> None:
    given = arguments(white_box)
    angles = np.asarray(_native.simulate_windows(**given))
    assert angles.shape == (3, 3, ROWS, 4)
    for window, first in enumerate((0, 50, 100)):
        arm = Arm(white_box)
        arm.reset(given["angles"][window])
        for row in range(ROWS):
            np.testing.assert_array_equal(angles[0, window, row], arm.angles)
            for n in range(SUBSTEPS):
                arm.step(given["volts"][(first + row) * SUBSTEPS + n], given["spacing"][first + row] / SUBSTEPS)


def test_velocities_offsets_and_sides_move_the_start() -> None:
    given = arguments(default_arm(), 1)
    plain = np.asarray(_native.simulate_windows(**given))
    moving = np.asarray(_native.simulate_windows(**(given | {"velocities": np.full((3, 4), 0.5)})))
    assert np.all(np.abs(moving - plain)[0, :, 1] > 1e-5)
    # A joint without gravity does not care where zero is.
    shifted = np.asarray(_native.simulate_windows(**(given | {"offsets": np.array([[0.3, 0.0, 0.0, 0.3]])})))
    np.testing.assert_allclose(shifted[..., [0, 3]], plain[..., [0, 3]], atol=1e-9)
    sides = np.asarray(_native.simulate_windows(**(given | {"sides": np.ones((3, 4))})))
    assert np.all(np.max(np.abs(sides - plain), axis=(0, 1, 2)) > 1e-4)


def test_the_log_leads_motors_to_where_their_teeth_bend(hidden: ArmParameters) -> None:
    """Motors hold the links against gravity; one that begins a window without the bend lets its link sink first."""
    plant = plant_row(hidden)
    plant[columns("half_gap")], plant[columns("stiffness")], plant[columns("mesh_damping")] = 0.0, 300.0, 0.3
    plant[columns("coulomb")] = plant[columns("breakaway")] = 0.0
    given, pose = arguments(hidden, 1), np.array([0.0, 0.3, 0.2, 0.0])
    still = np.zeros((len(given["spacing"]), 4))
    gravity = Body.of(plant).bias(pose[None], still[:1])[0]
    held = given | {
        "plants": plant[None],
        "angles": np.tile(pose, (3, 1)),
        "volts": np.tile(gravity / plant[columns("torque_per_volt")], (len(still) * SUBSTEPS, 1)),
        "log_angles": still + pose,
        "log_velocities": still,
        "log_places": still,
    }
    found = np.asarray(_native.simulate_windows(**held, led=np.array([0, 0, 100], dtype=np.int64)))[0]
    sunk = np.abs(found - pose).max(axis=1)
    assert np.all(sunk[2, 1:3] < 0.2 * sunk[1, 1:3])
    assert np.all(sunk[1, 1:3] > 5e-4)


def test_a_motor_that_the_log_leads_begins_beside_its_moving_link(hidden: ArmParameters) -> None:
    """Roll and motor turn evenly; one that begins ahead of its link, or behind it, kicks it by its teeth."""
    plant, roll, speed = plant_row(hidden), 3, 2.0
    plant[columns("half_gap")], plant[columns("stiffness")], plant[columns("mesh_damping")] = 0.0, 30.0, 0.0
    plant[columns("coulomb")] = plant[columns("breakaway")] = 0.0
    given = arguments(hidden, 1)
    even = np.zeros((len(given["spacing"]), 4))
    even[:, roll] = speed
    angles = even * (np.cumsum(given["spacing"]) - given["spacing"])[:, None]
    volts = even * plant[columns("damping")] / plant[columns("torque_per_volt")]
    moving = given | {
        "plants": plant[None],
        "angles": angles[given["first"]],
        "velocities": even[given["first"]],
        "volts": np.repeat(volts, SUBSTEPS, axis=0),
        "log_angles": angles,
        "log_velocities": even,
        "log_places": np.zeros_like(even),
    }
    found = np.asarray(_native.simulate_windows(**moving, led=np.array([0, 50, 100], dtype=np.int64)))[0]
    for window in (1, 2):  # of one lot, though one is led longer
        first = given["first"][window]
        np.testing.assert_allclose(found[window, :, roll], angles[first : first + ROWS, roll], atol=1e-4)


def test_windows_cover_the_log_without_gaps(recorded: Recorded) -> None:
    prepared = prepare(recorded.fit, 1)
    windows = windows_of(prepared)
    assert np.all(np.diff(windows.first) == windows.rows)
    assert (len(windows.first) + 1) * windows.rows >= len(recorded.fit.time) - 1
    np.testing.assert_array_equal(windows.measured[0, 0], recorded.fit.follower[0])


def test_of_many_windows_those_with_motion_stay_and_are_taken_evenly(recorded: Recorded) -> None:
    log = prepare(recorded.fit, 1)
    resting = replace(recorded.fit, follower=np.where(recorded.fit.time[:, None] < 4.0, 0.1, recorded.fit.follower))
    count = len(first_rows(log))
    whole = some_windows([log, prepare(resting, 1)], 2 * count)
    assert [list(numbers) for numbers in whole] == [list(range(count))] * 2
    few = some_windows([log, prepare(resting, 1)], count // 2)
    assert sum(map(len, few)) == pytest.approx(count // 2, abs=1)
    assert np.ptp(few[0]) > count // 2, "from all over the log"
    for first in first_rows(log)[few[1]]:
        assert np.ptp(resting.follower[first : first + 500], axis=0).max() > IDENTIFICATION_LIMITS.data.lively_rad


def test_truth_explains_the_log_and_the_white_box_does_not(
    recorded: Recorded, white_box: ArmParameters, hidden: ArmParameters
) -> None:
    """With the true arm only noise and backlash remain; the derivatives of the residual are finite everywhere."""
    log = prepare(recorded.fit, 1)
    residual = WindowResidual([log], white_box, range(4))
    zero = np.zeros(4)
    true, nominal = residual.mse(plant_row(hidden), zero), residual.mse(plant_row(white_box), zero)
    assert np.all(true < (4e-3) ** 2)
    assert true.sum() < 0.1 * nominal.sum()
    space = Space.of(white_box, MOTOR, range(4))
    points = space.start()[None] + np.vstack([np.zeros(12), 1e-3 * np.eye(12)])
    numbers = residual(space, points)
    assert numbers.shape == (13, len(residual.clusters))
    assert np.isfinite(numbers).all()
    assert np.all(np.abs(numbers[1:] - numbers[0]).max(axis=1) > 0.0)


def test_start_of_a_window_is_not_held_against_a_candidate(recorded: Recorded, white_box: ArmParameters) -> None:
    """An angle offset of one window costs about as much as the doubt about it, not as much as all its rows."""
    log = prepare(recorded.fit, 1)
    windows = windows_of(log, slice(0, 1))
    plants = plant_row(white_box)[None]
    error = np.full((1, 1, len(windows.time)), 3.0 * log.noise[0])
    left = take_off_starts(error, windows, log, plants, 0)[0]
    assert np.sum(left**2) < 12.0
    assert np.sum((error / log.noise[0]) ** 2) > 500.0


def test_joints_that_do_not_feel_each_other_share_a_simulation(recorded: Recorded, white_box: ArmParameters) -> None:
    """Derivatives with joints varied together are those of one number at a time, but for what coupling leaves out."""
    log = prepare(recorded.fit, 1)
    residual = WindowResidual([log], white_box, range(4))
    space = Space.of(white_box, (*MOTOR, "coulomb"), range(4))
    groups = space.groups()
    assert sorted(np.concatenate(groups)) == list(range(16))
    assert len(groups) == 8
    fit = WindowFit(residual, space, space.start())
    jacobian = fit.derivatives()
    moved = residual(space, space.start() + np.diag(space.steps)) - residual(space, space.start()[None])
    alone = (moved / space.steps[:, None]).T * space.moves(residual.joint_of)
    together = jacobian * space.moves(residual.joint_of)
    for index in range(len(space)):
        scale = np.linalg.norm(alone[:, index])
        assert np.linalg.norm(together[:, index] - alone[:, index]) < 0.15 * scale, space.names[index]


def test_the_side_of_the_gap_is_found(recorded: Recorded, white_box: ArmParameters, hidden: ArmParameters) -> None:
    """With the true arm and the sides that torques suggest, hunting joints look noisier than they are."""
    residual = WindowResidual([prepare(recorded.fit, 1)], white_box, range(4))
    plant, zero = plant_row(hidden), np.zeros(4)
    before = residual.mse(plant, zero)
    assert residual.settle(plant, zero)
    after = residual.mse(plant, zero)
    assert np.all(after <= 1.02 * before)
    assert after.sum() < 0.8 * before.sum()
