"""What is possible lies between the ideal controller and the one from before, also where these are nearly the same."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm.plants import columns
from greywhale.files.arm import default_arm
from greywhale.loop import default_controller, plant_row
from greywhale.protocol.table import ParameterTable
from greywhale.tune.limits import TUNING_LIMITS
from greywhale.tune.possible import lateness_s, scale_of
from greywhale.tune.search.objective import ErrorScale, follow
from greywhale.tune.search.training import TrainingMotion, training_motions

ARM = default_arm()
TABLE = ParameterTable.defaults()
PLANTS = np.repeat(plant_row(ARM)[None], 2, axis=0)
PLANTS[1, columns("torque_per_volt")] *= 1.3
BEFORE = default_controller()


@pytest.fixture(scope="module")
def motions() -> tuple[TrainingMotion, ...]:
    return training_motions(ARM, TABLE, PLANTS)


@pytest.fixture(scope="module")
def scale(motions: tuple[TrainingMotion, ...]) -> ErrorScale:
    return scale_of(motions, PLANTS, BEFORE)


@pytest.mark.slow
def test_the_floor_lies_below_any_controller_that_there_is(
    motions: tuple[TrainingMotion, ...], scale: ErrorScale
) -> None:
    found = follow(motions, PLANTS, BEFORE[None])
    assert scale.floor.shape == (2, len(motions), 4)
    assert (scale.floor > 0.0).all()
    assert (scale.floor < found.error[0]).all()
    np.testing.assert_allclose(scale.floor + scale.room, found.error[0])
    assert (scale.floor[1, 0] < 0.95 * scale.floor[0, 0]).all(), "a stronger arm has a lower one on large moves"
    assert (scale.floor[:, 0] > 2.0 * scale.room[:, 0]).all(), "large moves can hardly be helped"
    assert (scale.floor[:, 1:] < 0.5 * scale.room[:, 1:]).all(), "slow ones nearly all"


def test_a_joint_at_its_floor_has_room_all_the_same(
    motions: tuple[TrainingMotion, ...], scale: ErrorScale, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As if the controllers from before reached the floor, on one of the motions."""
    one = motions[1:2]
    floor = scale.floor[:, 1:2]
    found = follow(one, PLANTS, BEFORE[None])

    def ideal(*_: object, **__: object) -> object:
        return type(found)(floor[None], found.volts, found.rattle, found.chatter)

    monkeypatch.setattr("greywhale.tune.possible.follow", ideal)
    narrow = scale_of(one, PLANTS, BEFORE)
    cost = TUNING_LIMITS.cost
    np.testing.assert_allclose(narrow.room, np.maximum(cost.least_room_share * floor, cost.least_room_rad))


def test_a_board_hears_late_of_its_leader() -> None:
    assert lateness_s(TABLE.with_raw({"period_ms": 1, "filter_shift": 0})) == pytest.approx(1e-3)
    assert lateness_s(TABLE.with_raw({"period_ms": 1, "filter_shift": 1})) == pytest.approx(2e-3)
    assert lateness_s(TABLE.with_raw({"period_ms": 20, "filter_shift": 1})) == pytest.approx(11.5e-3)
