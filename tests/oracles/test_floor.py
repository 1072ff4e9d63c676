"""The saturation floor against optimisers that know what the leader will do: scipy's, over the voltages themselves."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm, toeplitz
from scipy.optimize import lsq_linear, minimize

from greywhale import _native
from greywhale.arm.plants import column
from greywhale.base.types import Floats
from greywhale.files.arm import default_arm, load_arm
from greywhale.loop import PLANT_COLUMNS, leader_slices, plant_row, steps
from greywhale.tune.judge.floor import saturation_floor

SLICE_S = 250e-6


def decoupled(inertia: float, damping: float, torque: float, supply: float) -> Floats:
    """A plant row of four joints without gravity, friction or gaps, whose links weigh nothing beside their motors."""
    row = plant_row(load_arm("grey_box"))
    values = {"torque_per_volt": torque, "inertia": inertia, "damping": damping, "coulomb": 0.0, "breakaway": 0.0}
    for index, place in enumerate(PLANT_COLUMNS):
        name = place.split(".")[-1]
        row[index] = values.get(name, row[index] if "." in place else 1e-9)
    row[column("supply")] = supply
    return row


def least_squares_of_a_jump(inertia: float, damping: float, torque: float, supply: float, seconds: float) -> float:
    """The least integral of e^2 after a jump of 1 rad: a convex quadratic programme over voltages held for 1 ms."""
    hold = 1e-3
    count = round(seconds / hold)
    system = np.array([[0.0, 1.0, 0.0], [0.0, -damping / inertia, torque / inertia], [0.0, 0.0, 0.0]])
    step = expm(system * hold)
    state, response = step[:2, 2], []
    for _ in range(count):
        response.append(state[0])
        state = step[:2, :2] @ state
    angle_per_volt = toeplitz(response, np.zeros(count))
    found = lsq_linear(angle_per_volt, np.ones(count), bounds=(-supply, supply), method="bvls", tol=1e-12)
    error = np.concatenate([[1.0], 1.0 - angle_per_volt @ found.x])
    return float(np.trapezoid(error**2) * hold)


@pytest.mark.parametrize("time_constant_s", [0.004, 0.05, 0.3])
def test_a_convex_programme_over_the_voltages_lies_between_bound_and_floor(time_constant_s: float) -> None:
    inertia, torque, supply, seconds = 0.05, 0.5, 15.0, 0.4
    damping = inertia / time_constant_s
    torque *= max(1.0, damping / 2.0)  # so that the slow ones arrive too
    least = least_squares_of_a_jump(inertia, damping, torque, supply, seconds)
    slices = np.zeros((round((0.5 + seconds) / SLICE_S), 4))
    slices[round(0.5 / SLICE_S) :] = 1.0
    floor = saturation_floor(slices, decoupled(inertia, damping, torque, supply))
    # A mean over ticks counts the first, of 1 rad^2, whole; the integral counts half of it.
    bound, reached = (one * (0.5 + seconds) - 0.5e-3 for one in (floor.bound, floor.mse))
    assert np.all(bound <= least)
    assert np.all(bound >= 0.97 * least)
    assert np.all(reached >= 0.998 * least)
    assert np.all(reached <= 1.003 * least)


HOLD_S, HORIZON_S = 10e-3, 0.3


class WholeArm:
    """Steps of 1 rad of all joints of an arm at rest, under voltages (holds, 4) that each last 10 ms."""

    def __init__(self, plant: Floats) -> None:
        self.plant = plant
        self.slices = round(HORIZON_S / SLICE_S)
        self.holds = round(HORIZON_S / HOLD_S)
        start = round(2.5 / SLICE_S)
        self.leader = leader_slices(steps(), 1.5)[start : start + self.slices]
        self.supply = float(plant[column("supply")])

    def costs(self, voltages: Floats) -> Floats:
        """Integrals of e^2 (rad^2 s), (n, 4), for n candidates; a pitch rests on the tooth that carries it."""
        count = len(voltages)
        volts = np.repeat(voltages, self.slices // self.holds, axis=1).reshape(-1, 4)
        at_rest = np.zeros((count, 4))
        angles = _native.simulate_windows(
            plants=self.plant[None],
            offsets=at_rest[:1],
            first=np.arange(count, dtype=np.int64) * self.slices,
            angles=at_rest,
            velocities=at_rest,
            sides=np.tile([0.0, 1.0, 1.0, 0.0], (count, 1)),
            places=at_rest,
            rows=self.slices,
            volts=np.ascontiguousarray(volts),
            spacing=np.full(count * self.slices, SLICE_S),
            substeps=1,
            every=1,
        )
        integrals: Floats = ((self.leader - angles[0]) ** 2).sum(axis=1) * SLICE_S
        return integrals

    def total_and_slope(self, flat: Floats) -> tuple[float, Floats]:
        """The sum over the joints, and its slope by central differences within the supply."""
        nudge = 0.02 * self.supply * np.eye(len(flat))
        tried = np.clip(flat + np.vstack([0.0 * nudge[:1], nudge, -nudge]), -self.supply, self.supply)
        totals = self.costs(tried.reshape(len(tried), self.holds, 4)).sum(axis=1)
        size = len(flat)
        apart = np.diagonal(tried[1 : size + 1] - tried[size + 1 :])
        return float(totals[0]), (totals[1 : size + 1] - totals[size + 1 :]) / apart


@pytest.mark.parametrize("name", ["default", "white_box"])
def test_an_optimiser_of_all_voltages_of_the_whole_arm_gains_less_than_one_per_cent(name: str) -> None:
    arm = default_arm() if name == "default" else load_arm(name)
    whole = WholeArm(plant_row(arm))
    best = np.inf
    for braking_s in (0.08, 0.1):
        start = np.zeros((whole.holds, 4))
        start[: round(braking_s / HOLD_S)] = whole.supply
        start[round(braking_s / HOLD_S) : round(1.5 * braking_s / HOLD_S)] = -whole.supply
        limits = [(-whole.supply, whole.supply)] * start.size
        found = start.ravel()
        for _ in range(3):  # a kink of friction or gap may end a descent early
            found = minimize(whole.total_and_slope, found, jac=True, method="L-BFGS-B", bounds=limits).x
        best = min(best, whole.total_and_slope(found)[0])
    floor = saturation_floor(steps(), arm)
    window_s = len(floor.time_s) * 1e-3
    assert floor.total * window_s <= 1.01 * best
    assert floor.bound.sum() * window_s <= best
