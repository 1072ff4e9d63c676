"""Potentiometers at a rail are named while the motors are off."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.board.pots import (
    FOLLOWERS,
    FULL_SCALE,
    LOOK_SAMPLES,
    POTS,
    PotReadings,
    counts_of,
    pots_there,
    read_pots,
    require_good_pots,
)
from greywhale.protocol import schema
from greywhale.protocol.schema import Fault
from greywhale.protocol.table import ParameterTable
from tests.board.fake_board import served

TABLE = ParameterTable.defaults()


def readings(pot: int, counts: int, seen_in: int = LOOK_SAMPLES) -> PotReadings:
    table = np.full((LOOK_SAMPLES, len(POTS)), 500)
    table[:seen_in, pot] = counts
    return PotReadings(table, 4)


@pytest.mark.parametrize(("counts", "fault"), [(4, "pot_low"), (5, "none"), (1018, "none"), (1019, "pot_high")])
def test_a_reading_within_rail_counts_of_an_end_is_at_the_rail(counts: int, fault: str) -> None:
    found = readings(6, counts)
    assert [found.at_rail(pot).key for pot in range(8)] == ["none"] * 6 + [fault, "none"]


def test_one_reading_at_a_rail_is_enough_and_is_told_in_a_sentence() -> None:
    (told,) = readings(2, 0, seen_in=1).complaints()
    assert told.startswith("leader potentiometer 2 reads 0..500 of 1023, at a rail (pot_low): check that")


def test_an_arm_with_a_broken_potentiometer_among_those_that_count_is_refused() -> None:
    with served() as (board, device):
        table = TABLE.with_raw({"leader2.zero": 5})  # its angle is then below the track
        require_good_pots(device, table, FOLLOWERS)
        with pytest.raises(UserError, match=rf"^{board.port}: leader potentiometer 2 reads 0..0 of 1023, at a rail"):
            require_good_pots(device, table, range(8))


def test_the_counts_are_those_that_the_board_has_converted() -> None:
    with served() as (board, device):
        found = read_pots(device, TABLE)
        assert board.asked(schema.TelemetryRequest) == 2, "on, and off again"
    assert found.counts.shape == (LOOK_SAMPLES, len(POTS))
    assert np.all((found.counts > 0) & (found.counts < FULL_SCALE))
    assert found.counts[0].tolist() == [512, 512, 507, 521, 512, 512, 512, 512]
    assert found.complaints() == []
    assert found.at_rail(0) is Fault.NONE


def test_a_potentiometer_that_is_not_there_reads_nothing_wrong() -> None:
    table = ParameterTable.defaults().with_raw({"follower3.scale": 0})
    assert pots_there(table) == tuple(range(7))
    sample = schema.Sample(1, schema.State.DISABLED, Fault.NONE, (0,) * 4, (0,) * 4, (0,) * 4)
    (counts,) = counts_of([sample], table)
    assert counts[7] == FULL_SCALE / 2
    assert counts[6] == pytest.approx(8184 / 16)
    zeros = np.zeros((LOOK_SAMPLES, 8), dtype=np.int64)
    assert PotReadings(zeros, 4, (0,)).complaints(range(1, 8)) == []
    assert PotReadings(zeros, 0).complaints() == [], "without rail counts nothing is a rail"
