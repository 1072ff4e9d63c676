"""Times and angles of another unit are named; honest odd files are not."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.files.leader import load_leader
from greywhale.files.log import read_log
from greywhale.files.log.layout import HEADING
from greywhale.files.log.parameters import lines_of
from greywhale.protocol.table import ParameterTable

MOTION = "time_s,leader_0,leader_1,leader_2,leader_3\n"
FACTS = "# every_ticks: 1\n# dropped_samples: 0\n"


def write_log(
    folder: Path, time_s: Sequence[float] | np.ndarray, facts: str = "", angle: float = 0.5, volts: float = 3.0
) -> Path:
    rows = [
        f"{time:.9f},{','.join([f'{angle * np.sin(row / 50):.5f}'] * 8)},{','.join([str(volts)] * 4)},following\n"
        for row, time in enumerate(time_s)
    ]
    path = folder / "log.csv"
    path.write_text(f"{facts}{HEADING}\n{''.join(rows)}")
    return path


def write_motion(folder: Path, time_s: np.ndarray, angle: float = 0.5, hz: float = 0.5) -> Path:
    path = folder / "motion.csv"
    wave = angle * np.sin(2.0 * np.pi * hz * np.arange(len(time_s)) / 50)
    path.write_text(MOTION + "".join(f"{t:.6f},{a:.5f},0,0,0\n" for t, a in zip(time_s, wave, strict=True)))
    return path


MS = np.arange(400) / 1000


@pytest.mark.parametrize(
    ("time_s", "words"),
    [
        (1e3 * MS, r"its rows are 1 s apart, but by its header \(every_ticks 1, .*0\) .* 1 ms .*is time_s in ms\?"),
        (1e6 * MS, r"1000 s apart, .* is time_s in us\?"),
        (MS / 60, r"0\.01667 ms apart, .* is time_s in min\?"),
        (2.0 * MS, "its rows are 2 ms apart, .* take the log as it was recorded, or correct its header"),
        (0.5 * MS, r"its rows are 0\.5 ms apart"),
        (20.0 * MS, "its rows are 20 ms apart"),
    ],
)
def test_rows_that_contradict_the_header_are_refused(tmp_path: Path, time_s: np.ndarray, words: str) -> None:
    path = write_log(tmp_path, time_s, FACTS)
    for read in (read_log, load_leader):
        with pytest.raises(UserError, match=words) as refused:
            read(path)
        assert refused.value.message.startswith(f"{path}: ")


@pytest.mark.parametrize(
    ("time_s", "facts"),
    [
        (MS + 5.0 * (MS > 0.1) + 300.0 * (MS > 0.3), FACTS),  # pauses
        (np.delete(MS, slice(3, 400, 4)), FACTS),  # a quarter is missing
        (3.0 * MS, "# every_ticks: 1\n# dropped_samples: 798\n"),  # a link that lost most
        (20.0 * MS, "# every_ticks: 20\n# dropped_samples: 0\n"),  # record --every
        (np.cumsum(np.tile([0.9e-3, 1.1e-3], 200)), FACTS),
        (20.0 * MS, "# firmware: 0.1.0\n"),
        (100.0 * MS[:9], FACTS),  # too few to tell
    ],
)
def test_honest_odd_times_pass(tmp_path: Path, time_s: np.ndarray, facts: str) -> None:
    path = write_log(tmp_path, time_s, facts)
    assert not any("time_s" in remark for remark in (*read_log(path).remarks, *load_leader(path).remarks))


@pytest.mark.parametrize(("factor", "unit"), [(1e3, "ms"), (1e6, "ms"), (1 / 60, "min")])
def test_times_of_a_log_without_facts_are_doubted(tmp_path: Path, factor: float, unit: str) -> None:
    log = read_log(write_log(tmp_path, factor * MS))
    assert any(f"apart, which no measure of an arm is made for; is time_s in {unit}?" in one for one in log.remarks)


@pytest.mark.parametrize("length_s", [10.0, 2.0])
def test_a_motion_in_ms_is_doubted_and_an_honest_one_is_not(tmp_path: Path, length_s: float) -> None:
    time_s = np.arange(0.0, length_s, 0.02)
    told = load_leader(write_motion(tmp_path, 100.0 * time_s, hz=0.5)).remarks
    assert "never exceeds 0.016 rad/s; is time_s in ms?" in told[0]
    for slow, angle, hz in ((1.0, 0.5, 0.5), (1.0, 1.5, 0.05), (100.0, 0.04, 0.5), (20.0, 0.5, 0.5)):
        assert load_leader(write_motion(tmp_path, slow * time_s, angle, hz)).remarks == ()


@pytest.mark.parametrize(
    ("angle", "words"),
    [
        (20.0, r"rad is beyond 8 rad; logs are in rad; angles reach 20, so they seem to be in degrees"),
        (90.0, r"angles reach 90, so they seem to be in degrees"),
        (5000.0, "logs are in rad.$"),
    ],
)
def test_degrees_in_a_log_are_named(tmp_path: Path, angle: float, words: str) -> None:
    with pytest.raises(UserError, match=words):
        read_log(write_log(tmp_path, MS, angle=angle))


@pytest.mark.parametrize(("angle", "doubted"), [(0.5, False), (3.0, False), (5.0, True), (7.9, True)])
def test_more_than_half_a_turn_is_doubted_where_nothing_tells_the_scale(
    tmp_path: Path, angle: float, doubted: bool
) -> None:
    """An arm of several turns is read all the same."""
    log = read_log(write_log(tmp_path, MS, angle=angle))
    assert np.abs(log.leader).max() == pytest.approx(angle, rel=1e-3)
    assert (
        f"log.csv: its angles reach {angle:g} rad, more than half a turn; are they in degrees?" in log.remarks[-1]
    ) is doubted


def test_a_log_with_its_parameters_is_not_doubted(tmp_path: Path) -> None:
    facts = "".join(f"# {line}\n" for line in lines_of(ParameterTable.defaults()))
    assert not any("degrees" in remark for remark in read_log(write_log(tmp_path, MS, facts, angle=7.9)).remarks)


def test_millivolts_are_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"12000 V is beyond 33 V; logs are in V; these seem to be in mV"):
        read_log(write_log(tmp_path, MS, volts=12_000.0))


@pytest.mark.parametrize(("angle", "named"), [(20.0, True), (180.0, True), (3.0, False), (6.0, False)])
def test_degrees_in_a_motion_are_named(tmp_path: Path, angle: float, named: bool) -> None:
    with pytest.raises(UserError, match=r"out of the potentiometers' range \[-2\.4, 2\.4\] rad") as refused:
        load_leader(write_motion(tmp_path, np.arange(0.0, 2.0, 0.02), angle))
    assert (f"angles reach {angle:g}, so they seem to be in degrees" in refused.value.message) is named
    assert ("shift or scale this joint" in refused.value.message) is not named


@pytest.mark.parametrize("time", ["inf", "-inf", "nan", "1e15", "-1e308", "1e308", "0", "", "0x1", "1_0", "-5"])
@pytest.mark.parametrize("read", [read_log, load_leader])
def test_impossible_times_get_one_sentence(tmp_path: Path, time: str, read: object) -> None:
    """In any row."""
    for row in (1, 30, 59):
        path = write_log(tmp_path, np.arange(1, 61) / 1000)
        lines = path.read_text().splitlines(keepends=True)
        lines[1 + row] = time + lines[1 + row][lines[1 + row].index(",") :]
        path.write_text("".join(lines))
        with pytest.raises(UserError, match=f"line {2 + row}, column time_s: ") as refused:
            assert callable(read)
            read(path)
        assert "\n" not in refused.value.message
