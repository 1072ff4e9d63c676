"""A potentiometer with an open or shorted wire is named before anybody starts a motor."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.board.device import Device
from greywhale.board.pots import FOLLOWERS, bad_pots, require_good_pots
from greywhale.errors import UserError
from greywhale.protocol.schema import Fault
from greywhale.table import ParameterTable
from tests.board.fake_board import FakeBoard, Faults

TABLE = ParameterTable.defaults()


def angle_of(table: ParameterTable, pot: str, count: int) -> int:
    """What the firmware makes of a 10-bit reading."""
    return (16 * count - table[f"{pot}.zero"]) * table[f"{pot}.scale"] + 4096 >> 13


def found_at(angles: tuple[int, int, int, int], table: ParameterTable = TABLE) -> list[tuple[int, Fault]]:
    with FakeBoard(Faults(followers=angles)) as board, Device(board.port, quiet_s=0.0, patience_s=0.5) as device:
        return [(pot.number, pot.fault) for pot in bad_pots(device, table)]


@pytest.mark.parametrize(("zero", "scale"), [(8184, 10734), (8184, -10734), (4000, 16384), (12000, -3000)])
def test_rails_are_told_from_readings_near_them_whichever_way_a_pot_turns(zero: int, scale: int) -> None:
    table = TABLE.with_raw({"follower2.zero": zero, "follower2.scale": scale})
    expected = {0: Fault.POT_LOW, 3: Fault.POT_LOW, 10: None, 1013: None, 1020: Fault.POT_HIGH, 1023: Fault.POT_HIGH}
    for count, fault in expected.items():
        angles = (0, 0, int(np.clip(angle_of(table, "follower2", count), -32768, 32767)), 0)
        assert found_at(angles, table) == ([] if fault is None else [(6, fault)]), count


def test_a_board_that_does_not_check_is_not_asked_to() -> None:
    assert found_at((0, 0, -32000, 0), TABLE.with_raw({"rail_counts": 0})) == []


def test_a_broken_pot_is_named_with_its_remedy() -> None:
    low = angle_of(TABLE, "follower1", 0)
    with FakeBoard(Faults(followers=(0, low, 0, 0))) as board:
        with Device(board.port, quiet_s=0.0, patience_s=0.5) as device:
            require_good_pots(device, TABLE, range(4))
            with pytest.raises(
                UserError, match="follower potentiometer 1 reads at the lower rail: check that p"
            ) as caught:
                require_good_pots(device, TABLE, FOLLOWERS)
    assert "clear the fault" not in caught.value.message
