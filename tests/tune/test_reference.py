"""The compiled cost of a candidate against its formulas in numpy, on motions that no arm would make."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greywhale import _native
from greywhale.base.limits import numbers_in
from greywhale.base.types import Floats
from greywhale.loop import Result
from greywhale.measure.swings import FOR_SIMULATIONS, Hunting, first_block
from greywhale.protocol.firmware import TICK_S, pwm_steps
from greywhale.protocol.schema import Board
from greywhale.tune.judge import margins
from greywhale.tune.judge.margins import SCENARIOS, TEETH
from greywhale.tune.judge.standard import Standard
from greywhale.tune.limits import TUNING_LIMITS
from greywhale.tune.search import objective
from greywhale.tune.search.objective import ErrorScale, FollowingErrors
from tests.tune import reference

SUPPLY_V, WAIT_S = 15.0, 0.2
RESTS = [(100, 400), (450, 900)]


def equal(found: Any, wanted: Any) -> None:
    np.testing.assert_allclose(found, wanted, rtol=1e-12, atol=0.0)


@pytest.fixture
def random() -> np.random.Generator:
    return np.random.default_rng(7)


def traces(random: np.random.Generator, ticks: int, count: int = 5) -> Result:
    """Candidates that wander, each quicker than the one before; the last one is lost."""
    size = 10.0 ** np.linspace(-4.0, -1.5, count)[:, None, None]
    angles = np.cumsum(size * random.normal(size=(count, ticks, 4)), axis=1)
    duties = np.round(60.0 * random.normal(size=(count, ticks, 4)) * np.linspace(0.1, 2.0, count)[:, None, None])
    mse, itae, itau = random.uniform(0.0, 0.1, (3, count, 4))
    time_s: Floats = np.arange(ticks, dtype=np.float64) * TICK_S
    lost = np.arange(count) == count - 1
    return Result(mse, itae, itau, lost, time_s, angles.astype(np.float32), duties.astype(np.int16))


@pytest.mark.parametrize("ticks", [350, 500, 1203])
@pytest.mark.parametrize("board", [Board.MEGA2560, Board.NANO328])
def test_following_is_measured_as_defined(random: np.random.Generator, ticks: int, board: Board) -> None:
    """Also in motions that are shorter than a joint takes to answer."""
    result = traces(random, ticks)
    leader = np.cumsum(1e-3 * random.normal(size=(ticks, 4)), axis=0)
    found = _native.follow(
        result=result,
        pwm_top=pwm_steps(board),
        leader=leader,
        total_weight=1.7,
        first_block=first_block(WAIT_S),
        measure=FOR_SIMULATIONS,
        cost=numbers_in(TUNING_LIMITS.cost),
    )
    wanted = reference.follow(result, leader, 1.7, WAIT_S, board)
    equal(found, np.stack(wanted, axis=-1))
    assert (np.asarray(found)[..., 3] > 0.0).any(), "some chatter"


def test_costs_are_as_defined(random: np.random.Generator) -> None:
    most = np.array([0.2, 9.0, 0.01, 150.0])[:, None, None, None, None]
    found = FollowingErrors(*random.uniform(0.0, most, (4, 6, 9, 3, 4)))
    before, floor, rattle = random.uniform(0.0, 0.1, (3, 9, 3, 4))
    cost = numbers_in(TUNING_LIMITS.cost)
    room = np.asarray(_native.rooms_of(before=before, floor=floor, cost=cost))
    equal(room, reference.room_of(before, floor))
    error = _native.errors_of(weighted=before[0], square=floor[0], cost=cost)
    equal(error, reference.error_of(before[0], floor[0]))
    scale = ErrorScale(floor, room, 0.1 * rattle)
    relative = objective.relative_costs(found, scale, SUPPLY_V)
    equal(relative, reference.relative_costs(found, scale, SUPPLY_V))
    importances = [2.0, 1.0, 1.0]
    equal(objective.total_costs(relative, importances), reference.total_costs(relative, importances))


@pytest.mark.parametrize("board", [Board.MEGA2560, Board.NANO328])
def test_unrest_is_measured_priced_and_judged_as_defined(random: np.random.Generator, board: Board) -> None:
    """In every scenario three candidates on two plants."""
    cycle = Hunting(0.005, 3)
    compiled, wanted = {}, {}
    for name in SCENARIOS[:-1]:
        result = traces(random, 1000, 6)
        numbers = np.asarray(
            _native.unrest(
                result=result,
                pwm_top=pwm_steps(board),
                rests=RESTS,
                band_rad=cycle.band_rad,
                turns=cycle.turns,
                supply_v=SUPPLY_V,
                swings=numbers_in(TUNING_LIMITS.swings),
                measure=FOR_SIMULATIONS,
            )
        )
        compiled[name] = margins.Unrest(numbers.reshape(3, 2, 4, -1))
        slow = reference.unrest(result, RESTS, cycle, SUPPLY_V, board)
        wanted[name] = reference.Unrest(*(value.reshape(3, 2, 4) for value in vars(slow).values()))
        for field, value in vars(wanted[name]).items():
            equal(getattr(compiled[name], field), value)
    assert 0 < sum(one.fails.sum() for one in wanted.values()) < 6 * 4 * len(wanted)
    quiet_v = 0.9 * wanted[SCENARIOS[0]].ripple[1].mean(axis=0)
    equal(margins.penalty(compiled, quiet_v), reference.penalty(wanted, quiet_v))
    failing = {name: random.integers(0, 2, 4) for name in compiled}
    kept = random.uniform(size=(3, 4)) < 0.5
    short = Standard(failing, quiet_v).falls_short(compiled, kept)
    np.testing.assert_array_equal(short, reference.falls_short(wanted, failing, quiet_v, kept))
    assert 0 < short.sum() < short.size
    assert TEETH in compiled
