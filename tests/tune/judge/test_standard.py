"""What a controller must hold to be uploaded."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.files.arm import default_arm
from greywhale.loop import default_controller, plant_row
from greywhale.protocol.table import ParameterTable
from greywhale.tune.judge.margins import AT_REST, DELAY, MOVING, TEETH, Margin, Margins
from greywhale.tune.judge.standard import Standard

SUPPLY_V = 15.0
NONE = np.zeros(4, dtype=bool)


def margins(**changes: tuple[int, float]) -> tuple[Margin, ...]:
    """Plants failing and ripple (V) of joint 1 by scenario; every other joint holds all."""
    names = {"at_rest": AT_REST, "delay": DELAY, "teeth": TEETH, "moving": MOVING}
    return tuple(
        Margin(name, joint, 0, 0.0, failing if joint == 1 else 0, 9, ripple_v=ripple if joint == 1 else 0.1)
        for key, name in names.items()
        for failing, ripple in [changes.get(key, (0, 0.1))]
        for joint in range(4)
    )


BEFORE = margins(delay=(2, 0.0))


@pytest.mark.parametrize(
    ("after", "short"),
    [
        (margins(delay=(2, 0.0)), False),  # as before
        (margins(delay=(3, 0.0)), True),
        (margins(at_rest=(1, 0.1)), True),
        (margins(moving=(1, 0.0)), True),
        (margins(teeth=(9, 0.0)), False),  # no part of it
        (margins(at_rest=(0, 0.46)), False),  # 3 % of the supply, and what noise alone changes
        (margins(at_rest=(0, 0.48)), True),
    ],
)
def test_nothing_may_get_worse_than_before(after: tuple[Margin, ...], short: bool) -> None:
    assert Standard.of(BEFORE, SUPPLY_V).joints_short(after, NONE).tolist() == [False, short, False, False]


def test_who_was_loud_may_stay_so_and_a_level_asks_for_more() -> None:
    loud = margins(at_rest=(0, 0.9))
    np.testing.assert_allclose(Standard.of(loud, SUPPLY_V).quiet_v, [0.45, 0.9, 0.45, 0.45])
    assert not Standard.of(loud, SUPPLY_V).joints_short(loud, NONE).any()
    assert Standard.of(loud, SUPPLY_V, level=2.0).joints_short(loud, NONE).tolist() == [False, True, False, False]


@pytest.mark.parametrize(("ripple_v", "short"), [(0.56, False), (0.57, True)])
def test_who_keeps_its_controller_may_be_shaken_by_its_neighbours(ripple_v: float, short: bool) -> None:
    after = margins(at_rest=(0, ripple_v))
    assert Standard.of(BEFORE, SUPPLY_V).joints_short(after, ~NONE).tolist() == [False, short, False, False]


def test_candidates_are_judged_as_the_margins_of_one_are() -> None:
    """The default controller, and one that hunts: Kp of joint 2 is far too large."""
    arm = default_arm()
    judge = Margins(arm, ParameterTable.defaults(), plant_row(arm)[None])
    wild = default_controller()
    wild[2, 8] *= 60
    rows = np.stack([default_controller(), wild])
    standard = Standard.of(judge.check(rows[0]), SUPPLY_V)
    many = standard.falls_short(judge.unrest(rows, exact=True), (rows == rows[0]).all(axis=2))
    assert not many[0].any()
    assert many[1, 2]
    assert standard.joints_short(judge.check(wild), NONE)[2]
