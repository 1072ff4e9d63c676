"""The paper's tuning to the letter: its budget, box, objective and independence, and what its objective leads to."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm.plants import column
from greywhale.loop import Experiment, default_controller, multi_steps, steps
from greywhale.tune import TuningResult, tune
from greywhale.tune.limits import WITHOUT_FLOORS
from greywhale.tune.model import Model, load_model
from greywhale.tune.paper import AGENTS, BUDGET, ITERATIONS, Loops, move_one_joint

BEFORE = default_controller()


@pytest.fixture(scope="module")
def model() -> Model:
    """The grey box of the paper's Table 4."""
    return load_model("grey_box", force=True)


@pytest.fixture(scope="module")
def tuned(model: Model) -> TuningResult:
    return tune(model, method="paper", strategy="mf", judging=WITHOUT_FLOORS)


def test_ten_agents_move_thirty_times_at_20_ms_and_the_models_supply(tuned: TuningResult, model: Model) -> None:
    assert (AGENTS, ITERATIONS) == (10, 30)
    assert tuned.budget == tuned.evaluations == BUDGET == 310
    assert tuned.curves[0].evaluations == tuple(range(10, 311, 10))
    assert all(after < before for before, after in zip(tuned.cost_before, tuned.cost_after, strict=True))
    for curve in tuned.curves:
        assert len(curve.cost) == ITERATIONS + 1
        assert (np.diff(curve.cost) <= 0.0).all()
    assert (tuned.period_ms, tuned.supply_v, model.table.period_ms) == (20, 15.0, 1)


def test_j_is_itae_plus_itau_of_the_joint_that_moves(model: Model) -> None:
    """Eqs. 19 to 21, integrated here from the trace of one joint's own step."""
    loops = Loops(model, "mf", BEFORE, 1)
    experiment = Experiment(
        move_one_joint(steps(), 2), model.arm, table=loops.table, noise=False, wait_s=0.1, soft_start=False
    )
    trace = experiment.run(BEFORE, loops.plant, every=1)
    k = np.maximum(trace.time_s - 1.1, 0.0)
    error = np.abs(experiment.leader[:, 2] - trace.angles[0, :, 2])
    volts = np.abs(trace.duties[0, :, 2]) / 400.0 * 15.0
    by_hand = 1e-3 * (k * (error + volts)).sum()
    assert loops.costs(BEFORE[None])[0, 2] == pytest.approx(by_hand, rel=5e-3)


def test_joints_are_tuned_on_their_own(model: Model) -> None:
    """What the others run is the controller from before, whatever is tried on them."""
    loops = Loops(model, "mf", BEFORE, 1)
    other = BEFORE.copy()
    other[:3, 8] *= 7
    np.testing.assert_array_equal(loops.costs(other[None])[0, 3], loops.costs(BEFORE[None])[0, 3])
    assert (loops.costs(other[None])[0, :3] != loops.costs(BEFORE[None])[0, :3]).all()
    motion = move_one_joint(multi_steps(), 1)
    assert np.ptp(motion.angles, axis=0).tolist() == [0.0, 2.0, 0.0, 0.0]


def test_only_sets_change_and_none_is_too_narrow(tuned: TuningResult) -> None:
    np.testing.assert_array_equal(tuned.after[:, 8:], BEFORE[:, 8:])
    assert (np.abs(tuned.after[:, :8]) >= 164).all()
    assert (np.sign(tuned.after[:, :8]) == [-1, -1, 1, 1] * 2).all()
    assert any("widths were below 0.01" in note for note in tuned.notes)


def test_factors_are_tuned_at_the_20_volts_of_table_8(model: Model) -> None:
    for strategy in ("sf", "both"):
        assert Loops(model, strategy, BEFORE, 1).plant[column("supply")] == 20.0
    outcome = tune(model, method="paper", strategy="sf", budget=20, judging=WITHOUT_FLOORS)
    assert outcome.supply_v == 20.0
    assert outcome.evaluations == 20
    assert outcome.after[:, 11].max() <= 20_000
    assert (outcome.after[:, 8:11] <= 3 << 16).all()
    np.testing.assert_array_equal(outcome.after[:, :8], BEFORE[:, :8])
