"""What a commissioning refuses to move, in one sentence."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.commission.journal import CommissioningJournal
from greywhale.commission.start import refuse_stuck, shares_moved
from greywhale.files.arm import default_arm
from greywhale.files.log import Log
from greywhale.files.log.layout import Origin
from greywhale.protocol.table import ParameterTable
from greywhale.tune.board_checks import refuse_uncalibrated
from tests.support.arms import make_arm
from tools.support.simulated_rig import ROOM, SimulatedRig


@pytest.fixture
def journal(tmp_path: Path) -> Iterator[CommissioningJournal]:
    with CommissioningJournal(tmp_path / "out", {}, resume=False) as journal:
        yield journal


def stuck(rig: SimulatedRig, journal: CommissioningJournal) -> None:
    refuse_stuck(rig, journal, ROOM)  # type: ignore[arg-type]


def test_an_arm_that_follows_is_moved_once(rig: SimulatedRig, journal: CommissioningJournal) -> None:
    stuck(rig, journal)
    assert len(rig.played) == 1
    stuck(rig, journal)
    assert len(rig.played) == 1, "not again after a break"


def test_friction_that_holds_a_joint_gets_a_larger_motion(journal: CommissioningJournal) -> None:
    held = 8.0 * default_arm().actuator(3).torque_per_volt  # V that friction takes
    rig = SimulatedRig(make_arm(joint_3={"friction": {"coulomb": held, "breakaway": held}}))
    stuck(rig, journal)
    assert len(rig.played) == 2


def test_a_joint_that_cannot_move_is_named(journal: CommissioningJournal) -> None:
    blocked = make_arm(joint_2={"friction": {"coulomb": 50.0, "breakaway": 50.0}})
    with pytest.raises(UserError, match=r"joint 2 \(wrist pitch\) did not move") as caught:
        stuck(SimulatedRig(blocked), journal)
    assert "joint 1" not in caught.value.message
    assert journal.get("first motion") is None


def test_a_joint_that_runs_the_wrong_way_is_named() -> None:
    time = np.arange(2000) / 1000
    leader = np.tile(np.minimum(0.3 * time, 0.15)[:, None], (1, 4))
    follower = leader * np.array([1.0, 0.9, -0.6, 0.05])
    log = Log("log", Origin(), time, leader, follower, 0.0 * leader, np.full(len(time), "following"), 0, True)
    assert shares_moved(log) == pytest.approx([1.0, 0.9, -0.6, 0.05], abs=0.05)


def test_a_joint_that_was_never_calibrated_is_named() -> None:
    """The arm file says where its potentiometer stands; the board still has the default."""
    refuse_uncalibrated(default_arm(), ParameterTable.defaults())
    arm = make_arm(follower_pots={"joint": {1: {"centre": 0.6}}})
    with pytest.raises(UserError, match=r"joint 1 \(shoulder pitch\) was never calibrated: .* 0.60 rad"):
        refuse_uncalibrated(arm, ParameterTable.defaults())
    table = ParameterTable.defaults()
    zero = round(16368 / 2 - 0.6 / table.physical("follower1.scale"))
    refuse_uncalibrated(arm, table.with_raw({"follower1.zero": zero}))
    with pytest.raises(UserError, match="is calibrated for another arm"):
        refuse_uncalibrated(default_arm(), table.with_raw({"follower1.zero": zero}))


def test_another_potentiometer_or_supply_than_the_arm_files_is_refused() -> None:
    with pytest.raises(UserError, match="follower potentiometer 2 turns 4.71 rad"):
        refuse_uncalibrated(make_arm(follower_pots={"joint": {2: {"track": 4.71}}}), ParameterTable.defaults())
    with pytest.raises(UserError, match="supply_mv says 9 V"):
        refuse_uncalibrated(default_arm(), ParameterTable.defaults().with_raw({"supply_mv": 9000}))
