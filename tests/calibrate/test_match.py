"""An arm file that matches a calibrated board: commission and tune find no contradiction between the two."""

from __future__ import annotations

import pytest

from greywhale.calibrate.match import with_board_pots
from greywhale.commission.start import refuse_uncalibrated
from greywhale.errors import UserError
from greywhale.files.arm import default_arm
from greywhale.firmware import ANGLE_LSB
from greywhale.table import ParameterTable
from tools.bench.hands import mounted_anyhow


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
