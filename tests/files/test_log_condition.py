"""The condition of a log: gaps are told, whether anybody counted what is missing or not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.files.leader import load_leader
from greywhale.files.log import LogWriter, read_log
from greywhale.files.log.condition import Gap, gaps_in
from greywhale.files.log.layout import Origin


def without(first: int, last: int, step: float = 0.001, count: int = 1000) -> np.ndarray:
    """Times of rows, of which some are missing."""
    time = step * np.arange(count)
    return np.delete(time, slice(first, last))


@pytest.mark.parametrize("step", [0.001, 0.02])
def test_a_gap_is_more_than_ten_samples(step: float) -> None:
    assert gaps_in(without(100, 110, step)) == ()
    assert gaps_in(without(100, 111, step)) == (Gap(round(99 * step, 6), round(12 * step, 6), 11),)


def test_rows_that_are_few_or_uneven_are_no_gaps() -> None:
    uneven = np.cumsum(np.random.default_rng(1).integers(1, 6, 500)) / 1000
    assert gaps_in(uneven) == ()
    assert gaps_in(np.array([0.0, 10.0])) == ()


@pytest.mark.parametrize("times", [[0.0, 5e-324, 1e-323, 1e308], [-1e308, 0.0, 1.0, 2.0, 3.0]])
def test_no_times_are_too_odd(times: list[float]) -> None:
    (gap,) = gaps_in(np.array(times))
    assert gap.samples < 1 << 63


@pytest.mark.parametrize("counted", [0, 400])
def test_a_log_and_a_motion_tell_where_samples_are_missing(tmp_path: Path, counted: int) -> None:
    path = tmp_path / "log.csv"
    with LogWriter(path, Origin(every_ticks=1)) as writer:
        for time in without(200, 600):
            writer.append(time, [0.1] * 4, [0.1] * 4, [0.0] * 4, "following")
        writer.drop(counted)
    log = read_log(path)
    assert log.condition.gaps == (Gap(0.199, 0.401, 400),)
    told = (f"{path}: samples are missing for 0.401 s (400 samples) after 0.199 s; nothing is known of the arm there.",)
    assert (log.remarks, load_leader(path).remarks) == (told, told)


def test_of_many_gaps_the_first_are_named(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    with LogWriter(path, Origin()) as writer:
        for row in range(120):
            writer.append(row / 1000 + row // 20, [0.1] * 4, [0.1] * 4, [0.0] * 4, "following")
    (remark,) = read_log(path).remarks
    assert remark.count("1.001 s (1000 samples) after") == 3
    assert "after 2.059 s, and 2 gaps more; nothing" in remark
