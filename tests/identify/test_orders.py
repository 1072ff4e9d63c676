"""A search adds what the log shows and leaves out what it does not: a shoulder that creeps, and whose pot has play."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.arm import ArmParameters
from greywhale.base.types import show_no_progress
from greywhale.identify.candidate import Candidate
from greywhale.identify.data import prepare
from greywhale.identify.search import Search
from greywhale.loop import human_reaches
from tests.identify.conftest import alone
from tests.support.arms import make_arm
from tools.support.recordings import record, table_of


def found_in(motion: int, white_box: ArmParameters, folder: Path) -> Candidate:
    """The model that a search finds in 12 s of that shoulder alone."""
    friction = {"coulomb": 0.5, "breakaway": 0.5, "creep_velocity": 0.07}  # N m, N m, rad/s
    pots = {"joint": {"noise": 0.002, "play": 0.006}}  # V, rad
    worn = make_arm(white_box, follower_pots=pots, joint_1={"friction": friction})
    log = record(worn, alone(human_reaches(motion, 12.0)), folder / "fit.csv", table_of("before_tuning"))
    search = Search(white_box, [prepare(log, 1)], (), (1,), 0, show_no_progress)
    search.run()
    assert search.best is not None
    return search.best


def test_creep_is_found_where_half_of_the_windows_hide_it(white_box: ArmParameters, tmp_path: Path) -> None:
    found = found_in(4, white_box, tmp_path)
    assert "creep" in found.kinds
    values = dict(zip(found.space.names, found.space.values(found.x), strict=True))
    assert values["joint1.creep"] == pytest.approx(0.07, abs=0.01)
    assert values["joint1.inertia"] == pytest.approx(0.0291, rel=0.05)


def test_an_order_goes_that_later_ones_make_needless(white_box: ArmParameters, tmp_path: Path) -> None:
    """Stribeck friction and a gap helped before creep and play were known."""
    found = found_in(6, white_box, tmp_path)
    assert set(found.order.split(", ")) == {"creep", "play at the potentiometers"}
