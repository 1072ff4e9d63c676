"""Batches: the same bits however computed, close to a fine reference, finite whatever comes, also with late duties."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from greywhale import _native
from greywhale.arm.plants import column, columns
from greywhale.base.types import Floats
from greywhale.files.arm import default_arm, load_arm
from greywhale.loop import PLANT_COLUMNS, Experiment, Result, Timing, default_controller, human_reaches, plant_row
from greywhale.protocol.table import ParameterTable
from tests.loop.on_the_bench import quiet

INTEGERS = npt.NDArray[np.int32]


def search_box(arm: str, count: int, spread: float, seed: int) -> tuple[INTEGERS, Floats]:
    """Controllers within e^+-0.5 of the defaults, plants within e^+-spread of an arm, gears and friction too."""
    random = np.random.default_rng(seed)
    plants = np.repeat(plant_row(load_arm(arm))[None], count, axis=0)
    for name in ("torque_per_volt", "inertia", "damping", "half_gap", "stiffness"):
        plants[:, columns(name)] *= np.exp(random.uniform(-spread, spread, (count, 4)))
    plants[:, columns("coulomb") + columns("breakaway")] *= np.exp(random.uniform(-1, 0.5, (count, 1)))
    controllers = np.repeat(default_controller()[None], count, axis=0).astype(np.float64)
    controllers[:, :, 8:11] *= np.exp(random.uniform(-0.5, 0.5, (count, 4, 3)))
    controllers[:, :, 11] *= random.uniform(0.6, 1.0, (count, 4))
    return controllers.astype(np.int32), plants


def same(a: Result, b: Result) -> None:
    for name in ("mse", "itae", "itau", "diverged", "angles", "duties"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=name)


@pytest.fixture(scope="module")
def experiment() -> Experiment:
    return Experiment(human_reaches(4, 5.0), default_arm())


def test_threads_neighbours_and_instruction_sets_change_no_bit(experiment: Experiment) -> None:
    controllers, plants = search_box("default", 37, 1.0, seed=1)
    plants[::3, columns("stop_max")] = 0.5  # some run against a stop all the time
    first = experiment.run(controllers, plants, every=7, threads=1)
    assert (first.angles[::3].max(axis=(1, 2)) <= 0.5 + 1e-6).all()
    assert first.angles[1::3].max() > 0.6
    same(first, experiment.run(controllers, plants, every=7, threads=3))
    for instructions in _native.instruction_sets()[1:]:
        other = Experiment(human_reaches(4, 5.0), default_arm(), instructions=instructions)
        same(first, other.run(controllers, plants, every=7))
    order = np.random.default_rng(2).permutation(37)
    shuffled = experiment.run(np.ascontiguousarray(controllers[order]), np.ascontiguousarray(plants[order]), every=7)
    np.testing.assert_array_equal(shuffled.mse, first.mse[order])
    np.testing.assert_array_equal(shuffled.duties, first.duties[order])


def test_an_unknown_instruction_set_is_refused() -> None:
    with pytest.raises(ValueError, match='the instruction set "mmx" is not known'):
        Experiment(human_reaches(4, 1.0), default_arm(), instructions="mmx")


def test_the_wires_of_a_motor_change_nothing() -> None:
    """An arm's model knows no wires: a board whose motor_sign puts them right follows like any other."""
    motion, table = human_reaches(4, 2.0), ParameterTable.defaults()
    wired = Experiment(motion, default_arm(), table=table.with_raw({"joint2.motor_sign": -1}))
    same(wired.run(every=5), Experiment(motion, default_arm(), table=table).run(every=5))


def test_steps_of_a_slice_follow_the_single_run_tick_by_tick() -> None:
    """Four steps a tick are the exact run but for its double precision: the same noise, and so the same duties until a
    reading tips over. With noise of another seed nineteen of twenty differ.
    """
    experiment = Experiment(human_reaches(4, 5.0), default_arm(), timing=Timing(late=3))
    batch, exact = experiment.run(every=1, steps_per_tick=4), experiment.run_exact(every=1)
    moving = 2500
    assert np.abs(exact.duties[0, :moving]).max() > 40
    differ = (batch.duties[0, :moving] != exact.duties[0, :moving]).mean()
    assert differ < 0.02
    np.testing.assert_allclose(batch.angles[0, :moving], exact.angles[0, :moving], atol=2e-3)


# Largest error of the total mean squared error against steps of 25 us: median, nine of ten candidates.
BOUNDS = {
    ("grey_box", 2.0): {4: (0.002, 0.01), 2: (0.002, 0.01), 1: (0.004, 0.02)},
    ("default", 0.4): {4: (0.01, 0.06), 2: (0.015, 0.1), 1: (0.02, 0.16)},
}


@pytest.mark.slow
@pytest.mark.parametrize(("arm", "spread"), list(BOUNDS))
def test_error_against_a_fine_reference(arm: str, spread: float) -> None:
    experiment = Experiment(human_reaches(4, 4.0), default_arm())
    controllers, plants = search_box(arm, 16, spread, seed=3)
    fine = experiment.run_exact(controllers, plants, steps_per_slice=10).mse.sum(axis=1)
    for steps, (median, most) in BOUNDS[arm, spread].items():
        error = np.abs(experiment.run(controllers, plants, steps_per_tick=steps).mse.sum(axis=1) / fine - 1)
        assert np.median(error) < median, steps
        assert np.quantile(error, 0.9) < most, steps


def test_impossible_plants_cost_much_but_never_nan(experiment: Experiment) -> None:
    """A mass matrix that is not positive definite, and strengths from 1e-12 to 1e12."""
    random = np.random.default_rng(1)
    controllers, plants = search_box("default", 64, 1.0, seed=5)
    plants[:32, PLANT_COLUMNS.index("ixx3")] = 10.0
    strength = columns("torque_per_volt") + columns("inertia") + columns("damping")
    plants[32:, strength] *= 10.0 ** random.uniform(-12, 12, (32, 12))
    for result in (experiment.run(controllers, plants), experiment.run_exact(controllers, plants)):
        for measure in (result.mse, result.itae, result.itau):
            assert np.isfinite(measure).all()
        assert (result.mse[result.diverged] == 1e9).all()
        assert (result.mse[~result.diverged] < 100).all(), "the stops hold the arm within a few radians"


LATE = 7


def stuck() -> np.ndarray:
    """A follower that nothing moves, so that the duties follow from the leader alone."""
    plant = plant_row(default_arm())
    for joint in range(4):
        for name in ("coulomb", "breakaway"):
            plant[column(name, joint)] = 1e6
    return plant


@pytest.mark.parametrize("run", ["run", "run_exact"])
def test_late_duties_are_the_prompt_ones_shifted(run: str) -> None:
    motion, arm = human_reaches(3, 4.0), quiet(default_arm())
    traces = {}
    for late in (0, LATE):
        experiment = Experiment(motion, arm, timing=Timing(late=late), noise=False)
        traces[late] = getattr(experiment, run)(None, stuck(), every=1).duties[0]
    assert len(np.unique(traces[0])) > 50, "the motors were hardly driven, so little is compared"
    np.testing.assert_array_equal(traces[LATE][LATE:], traces[0][:-LATE])
    assert (traces[LATE][:LATE] == 0).all()
