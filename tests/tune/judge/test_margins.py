"""What counts as a limit cycle, and whether a controller still comes to rest with other loop gains, delay or teeth."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale import _native
from greywhale.arm.plants import columns
from greywhale.files import controller
from greywhale.files.arm import default_arm
from greywhale.loop import controller_row, default_controller, plant_row
from greywhale.measure.limits import SWING_BOUNDS
from greywhale.protocol.table import ParameterTable
from greywhale.tune.judge.margins import (
    DELAY,
    MOVING,
    SCENARIOS,
    TEETH,
    Margins,
    penalty,
    with_gain,
    with_softer_teeth,
)
from greywhale.tune.limits import TUNING_LIMITS
from tools import ROOT

ARM = default_arm()
PLANTS = plant_row(ARM)[None]
BEFORE = default_controller()
TABLE_9 = controller_row(controller.load(ROOT / "shared" / "fuzzy_tables" / "table_9.toml"))
ANY_RIPPLE = np.full(4, np.inf)


def turning_points(signal: np.ndarray, band: float) -> list[float]:
    """The definition, slowly: extremes between legs longer than the band, found by going through all values."""
    points: list[float] = []
    extreme, direction = [signal[0], signal[0]], 0
    for value in signal[1:]:
        extreme = [min(extreme[0], value), max(extreme[1], value)]
        if direction >= 0 and value < extreme[1] - band:
            points += [extreme[1]] if direction else []
            direction, extreme = -1, [value, value]
        elif direction <= 0 and value > extreme[0] + band:
            points += [extreme[0]] if direction else []
            direction, extreme = 1, [value, value]
    return points


@pytest.mark.parametrize("kind", [np.float32, np.int16])
def test_swings_are_counted_as_defined(kind: type) -> None:
    random = np.random.default_rng(4)
    signals = np.cumsum(random.normal(size=(5, 400, 4)), axis=1) * 3.0
    signals[0, :, 0] = 7.0
    signals[0, :, 1] = np.arange(400)
    traces: np.ndarray = np.ascontiguousarray(signals.astype(kind))
    reversals, travel = _native.swings(traces, 50, 380, 5.0)
    for n in range(5):
        for joint in range(4):
            points = turning_points(traces[n, 50:380, joint].astype(np.float64), 5.0)
            assert reversals[n, joint] == len(points)
            assert travel[n, joint] == pytest.approx(np.abs(np.diff(points)).sum())
    assert reversals[0, :2].tolist() == [0, 0]
    assert reversals.max() > 5


@pytest.fixture(scope="module")
def margins() -> Margins:
    return Margins(ARM, ParameterTable.defaults(), PLANTS)


def test_the_default_controller_comes_to_rest_in_every_scenario(margins: Margins) -> None:
    verdicts = margins.check(BEFORE)
    assert {(one.scenario, one.joint) for one in verdicts} == {
        (name, joint) for name in SCENARIOS for joint in range(4)
    }
    assert all(one.holds for one in verdicts)


def test_table_9_swings_at_rest(margins: Margins) -> None:
    """The paper's sets and factors together: the roll joint goes to and fro by 17 mrad, and its duty with it."""
    at_rest = {one.joint: one for one in margins.check(TABLE_9) if one.scenario == "at rest"}
    assert not at_rest[3].holds
    assert at_rest[3].reversals > 10
    assert at_rest[2].holds


def test_a_roll_joint_with_four_times_the_gain_rattles_while_it_moves(margins: Margins) -> None:
    bold = BEFORE.copy()
    bold[3, 8] *= 4
    moving = [one for one in margins.check(bold) if one.scenario == MOVING]
    assert [one.holds for one in moving] == [True, True, True, False]
    assert moving[3].rattle_rad > SWING_BOUNDS.rattle_moving_rad
    assert moving[3].chatter_hz < 10.0
    assert all(one.rattle_rad < 0.5 * SWING_BOUNDS.rattle_moving_rad for one in moving[:3])


def test_more_gain_and_more_delay_bring_instability_nearer(margins: Margins) -> None:
    """Of a loop with little left, at the border: what is quiet as it is swings in the scenarios meant for that."""
    bold = BEFORE.copy()
    bold[3, 8] *= 4
    bold[3, 9] *= 2
    found = margins.unrest(bold[None])
    assert found["at rest"].reversals[0, 0, 3] < 3
    assert found["half the loop gain"].reversals[0, 0, 3] < 3
    assert found["twice the loop gain"].reversals[0, 0, 3] > 3
    assert found["twice the loop gain"].travel[0, 0, 3] > 0.05


def test_the_quiet_pay_nothing_and_the_others_more_the_more_they_swing(margins: Margins) -> None:
    wilder = TABLE_9.copy()
    wilder[3, 8] *= 4
    prices = penalty(margins.unrest(np.stack([BEFORE, TABLE_9, wilder])), ANY_RIPPLE)
    assert (prices[0] == 0.0).all()
    assert 0.02 < prices[1, 3] < prices[2, 3]


def test_ripple_costs_something_and_what_is_beyond_the_limit_much(margins: Margins) -> None:
    louder = BEFORE.copy()
    louder[:, 9] *= 3  # Kd
    found = margins.unrest(np.stack([BEFORE, louder]))
    quiet, loud = found["at rest"].ripple[:, 0]
    assert (loud > 2.0 * quiet).all()
    within, beyond = (penalty(found, limit)[1] - penalty(found, ANY_RIPPLE)[1] for limit in (2.0 * loud, 0.5 * loud))
    np.testing.assert_allclose(within, 0.5 * TUNING_LIMITS.margins.ripple_price)
    assert (beyond > 1.0).all()


def test_a_search_stops_short_of_the_border() -> None:
    """Whatever the check takes for a limit cycle costs a search something, and more scenarios besides."""
    searching = Margins(ARM, ParameterTable.defaults(), PLANTS, searching=True)
    random = np.random.default_rng(1)
    rows = np.repeat(BEFORE[None], 24, axis=0).astype(np.float64)
    rows[:, :, 8:10] *= np.exp(random.uniform(-0.5, 1.2, (24, 4, 2)))
    candidates = rows.astype(np.int32)
    strict = penalty(searching.unrest(candidates), ANY_RIPPLE) > 0.0
    failing = np.any(
        [one.fails[:, 0] for one in Margins(ARM, ParameterTable.defaults(), PLANTS).unrest(candidates).values()], axis=0
    )
    assert 5 < failing.sum() < 80
    assert strict[failing].mean() > 0.97
    assert strict.sum() > failing.sum()


def test_scenarios_change_what_they_say() -> None:
    doubled = with_gain(PLANTS, 2.0)
    changed = np.flatnonzero((doubled != PLANTS)[0]).tolist()
    assert changed == sorted(columns("torque_per_volt"))
    np.testing.assert_allclose(doubled[:, changed], 2.0 * PLANTS[:, changed])
    softer = with_softer_teeth(PLANTS)
    assert np.flatnonzero((softer != PLANTS)[0]).tolist() == sorted(columns("stiffness") + columns("mesh_damping"))
    np.testing.assert_allclose(softer[:, columns("stiffness")], PLANTS[:, columns("stiffness")] / 4)
    assert {DELAY, TEETH} < set(SCENARIOS)


def test_rigid_gears_stay_rigid() -> None:
    rigid = PLANTS.copy()
    rigid[:, columns("half_gap") + columns("stiffness") + columns("mesh_damping")] = 0.0
    found = Margins(ARM, ParameterTable.defaults(), rigid).unrest(BEFORE[None])
    assert not any(one.lost.any() for one in found.values())
