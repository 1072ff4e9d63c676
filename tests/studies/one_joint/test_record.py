"""Records: what they refuse, where pieces of them start, and that a start knows the past only."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greywhale.base.errors import UserError
from studies.one_joint import Record, pieces_of
from tests.studies.one_joint.records import still


def parabola() -> Record:
    record = still(1.0)
    return replace(record, follower=0.2 + 0.5 * record.time - 3.0 * record.time**2)


def test_a_piece_starts_at_the_angle_and_speed_that_the_rows_before_it_say() -> None:
    record = parabola()
    later = record.follower.copy()
    later[401:] = 9.0
    for known in (record, replace(record, follower=later)):
        angle, speed = known.start(400)
        assert angle == pytest.approx(record.follower[400], abs=1e-9)
        assert speed == pytest.approx(0.5 - 6.0 * record.time[400], abs=1e-6)


def test_coarse_readings_are_smoothed_over_longer() -> None:
    step = 0.06
    record = still(2.0)
    true = 0.4 * record.time
    coarse = replace(record, follower=step * np.floor(true / step + 0.5), resolution=step)
    starts = np.array([coarse.start(row) for row in range(500, 2000, 50)])
    assert np.std(starts[:, 0] - true[500:2000:50]) < 0.5 * step
    assert np.std(starts[:, 1] - 0.4) < 0.3


def test_pieces_cover_their_part_of_the_record_and_no_more() -> None:
    pieces = pieces_of(parabola(), 300, 950, 0.2)
    assert pieces.first.tolist() == [300, 500, 700]
    assert pieces.rows == 200
    whole = pieces_of(parabola(), 300, 950)
    assert (whole.first.tolist(), whole.rows) == ([300], 650)


def test_the_middle_is_that_of_time() -> None:
    record = still(1.0)
    warped = replace(record, time=record.time**2 + record.time)
    assert warped.time[warped.middle] == pytest.approx(0.5 * warped.time[-1], rel=0.01)
    assert len(warped.until(warped.middle).time) == warped.middle


def test_what_is_no_record_is_refused_by_name() -> None:
    record = still(1.0)
    with pytest.raises(UserError, match="still: volts must hold a finite number for each of 1000 rows"):
        replace(record, volts=np.full(1000, np.nan))
    with pytest.raises(UserError, match="still: at least 20 rows with rising times"):
        replace(record, time=record.time[::-1])
