"""An arm file that matches a calibrated board: commission and tune find no contradiction between the two."""

from __future__ import annotations

import pytest

from greywhale.base.errors import UserError
from greywhale.board.calibrate.match import with_board_pots
from greywhale.commission.start import refuse_uncalibrated
from greywhale.files.arm import default_arm
from greywhale.protocol.firmware import ANGLE_LSB
from greywhale.protocol.table import ParameterTable
from tools.support.hands import mounted_anyhow


def calibrated(seed: int) -> ParameterTable:
    """A table that reads these random potentiometers rightly."""
    arm = mounted_anyhow(seed)
    changes = {}
    for side, bank in (("leader", arm.leader_pots), ("follower", arm.follower_pots)):
        for joint, pot in enumerate(bank.joint):
            scale = pot.direction * pot.track / 16368
            changes[f"{side}{joint}.scale"] = round(scale * 2**25)
            changes[f"{side}{joint}.zero"] = round(8184 - pot.centre / scale)
    return ParameterTable.defaults().with_raw(changes)


@pytest.mark.parametrize("seed", range(1, 6))
def test_the_boards_potentiometers_are_found_in_its_table(seed: int) -> None:
    true, table = mounted_anyhow(seed), calibrated(seed)
    with pytest.raises(UserError, match="correct the one that is wrong"):
        refuse_uncalibrated(default_arm(), table)
    found = with_board_pots(default_arm(), table)
    refuse_uncalibrated(found, table)
    for side in ("leader_pots", "follower_pots"):
        for one, other in zip(getattr(found, side).joint, getattr(true, side).joint, strict=True):
            assert one.track == pytest.approx(other.track, rel=1e-4)
            assert one.centre == pytest.approx(other.centre, abs=2 * ANGLE_LSB)
            assert one.direction == other.direction
            assert one.noise == other.noise
    assert found.joint == default_arm().joint


def test_an_arm_and_a_board_with_other_joints_do_not_match() -> None:
    table = calibrated(1).with_raw({"follower2.scale": 0, "leader2.scale": 0, "leader0.scale": 0})
    with pytest.raises(UserError, match="the arm file uses all four joints, but the board uses joints 0, 1 and 3"):
        with_board_pots(default_arm(), table)
    joints = [one.model_copy(update={"fixed": joint == 2}) for joint, one in enumerate(default_arm().joint)]
    arm = default_arm().model_copy(update={"joint": tuple(joints)})
    found = with_board_pots(arm, table)
    assert found.leader_pots.joint[0] == arm.leader_pots.joint[0], "a host leads that joint"
    assert found.follower_pots.joint[0] != arm.follower_pots.joint[0]
