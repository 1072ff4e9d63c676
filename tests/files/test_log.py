"""Logs: what is written is what is read, whole or marked, and doubt is refused."""

from __future__ import annotations

import contextlib
import csv
import os
import resource
import tracemalloc
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from greywhale.base.errors import UserError
from greywhale.base.formats import csv_file
from greywhale.files.log import Log, LogWriter, read_log
from greywhale.files.log.check import Check
from greywhale.files.log.held import Packed
from greywhale.files.log.layout import HEADING, QUANTITIES, STATES, Origin
from greywhale.files.log.reader import parse_rows

ORIGIN = Origin("1.2.3", "mega2560", 0xBEEF, 20, 5)
ROW = ([0.1, 0.2, 0.3, 0.4], [-0.1, -0.2, -0.3, -0.4], [1.0, -2.0, 15.0, 0.001], "following")

raw_angle = st.integers(-32768, 32767)
samples = st.tuples(
    st.integers(1, 60_000),  # ticks since the sample before
    st.tuples(*[raw_angle] * 8),
    st.tuples(*[st.integers(-32768, 32767)] * 4),
    st.sampled_from(STATES),
)


def write(path: Path, count: int = 3, dropped: int = 0) -> None:
    with LogWriter(path, ORIGIN) as log:
        for row in range(count):
            log.append(row * 0.005, *ROW)
        log.drop(dropped)


@given(st.lists(samples, min_size=2, max_size=30), st.integers(0, 10**9))
@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_every_count_of_the_board_survives(
    tmp_path: Path, rows: list[tuple[int, tuple[int, ...], tuple[int, ...], str]], dropped: int
) -> None:
    ticks = np.cumsum([row[0] for row in rows])
    with LogWriter(tmp_path / "log.csv", ORIGIN) as log:
        for tick, (_, angles, volts, state) in zip(ticks, rows, strict=True):
            radians = [angle / 4096 for angle in angles]
            log.append(tick / 1000, radians[:4], radians[4:], [volt / 1000 for volt in volts], state)
        log.drop(dropped)
    read = read_log(tmp_path / "log.csv")
    assert np.array_equal(np.round(read.time * 1000), ticks)
    assert np.array_equal(np.round(np.hstack([read.leader, read.follower]) * 4096), [row[1] for row in rows])
    assert np.array_equal(np.round(read.voltage * 1000), [row[2] for row in rows])
    assert list(read.state) == [row[3] for row in rows]
    assert (read.dropped, read.complete, read.origin) == (dropped, True, ORIGIN)


def test_what_was_recorded_before_an_interruption_is_kept_and_marked(path: Path, tmp_path: Path) -> None:
    with pytest.raises(SystemExit), LogWriter(path, ORIGIN) as writer:
        for row in range(7):
            writer.append(row * 0.001, *ROW)
        writer.drop(2)
        raise SystemExit
    log = read_log(path)
    assert (len(log.time), log.dropped, log.complete) == (7, 2, False)
    assert log.condition.check is Check.WHOLE
    assert os.listdir(tmp_path) == ["log.csv"]


@contextlib.contextmanager
def disk_for(size: int) -> Iterator[None]:
    """Files end at this many bytes, in the middle of a write, as they do on a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_on_a_full_disk_the_lines_that_are_whole_stay(path: Path, tmp_path: Path) -> None:
    with disk_for(20_000), pytest.raises(UserError, match=r"log\.csv: cannot be written: "):
        write(path, 300)
    log = read_log(path)
    assert 100 < len(log.time) < 300
    assert not log.complete
    assert log.condition.check is Check.WHOLE
    assert 19_800 < path.stat().st_size <= 20_000
    assert os.listdir(tmp_path) == ["log.csv"]


def test_without_room_for_the_header_nothing_stays(tmp_path: Path) -> None:
    with disk_for(50), pytest.raises(UserError, match=r"log\.csv: cannot be written: "):
        write(tmp_path / "log.csv", 10)
    assert os.listdir(tmp_path) == []


def test_an_empty_recording_leaves_the_old_file_and_nothing_else(path: Path, tmp_path: Path) -> None:
    path.write_text("precious")
    with LogWriter(path, ORIGIN):
        pass
    assert path.read_text() == "precious"
    assert os.listdir(tmp_path) == ["log.csv"]


@pytest.mark.parametrize(
    ("time", "leader", "state"),
    [
        (0.0, ROW[0], "following"),
        (-1.0, ROW[0], "following"),
        (1.0, ROW[0][:3], "following"),
        (1.0, [float("nan"), *ROW[0][1:]], "following"),
        (float("inf"), ROW[0], "following"),
        (1.0, ROW[0], "dancing"),
    ],
)
def test_the_writer_refuses_what_the_reader_would(tmp_path: Path, time: float, leader: list[float], state: str) -> None:
    with LogWriter(tmp_path / "log.csv", ORIGIN) as log:
        log.append(0.0, *ROW)
        with pytest.raises((ValueError, OverflowError)):
            log.append(time, leader, ROW[1], ROW[2], state)


def test_a_period_that_the_rows_contradict_is_refused(path: Path) -> None:
    """The voltages change at every row of 1 ms, or at every 20th."""

    def write_changing(every: int, period_ms: int) -> None:
        with LogWriter(path, replace(ORIGIN, period_ms=period_ms, every_ticks=1)) as log:
            for row in range(3000):
                log.append(row * 0.001, ROW[0], ROW[1], [0.1 * (row // every % 7)] * 4, "following")

    for every, period_ms in ((1, 1), (20, 20), (20, 1), (40, 20)):
        write_changing(every, period_ms)
        assert len(read_log(path).time) == 3000
    write_changing(1, 20)
    with pytest.raises(UserError, match=f"{path}: period_ms is 20 .* every 1 ms"):
        read_log(path)


def changed(folder: Path, old: str, new: str) -> Log:
    path = folder / "log.csv"
    write(path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    return read_log(path)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("following\n", "dancing\n", "line 12, column state: 'dancing' is not one of boot, disabled"),
        ("0.005000,", "0.000000,", "line 13, column time_s: time must increase"),
        *[("0.010000,", f"{time},", f"line 14, column time_s: {time} ") for time in ("inf", "nan", "1e15", "1e308")],
        ("0.005000,", "0.0000001,", "line 13, column time_s: time must increase by a microsecond"),
        ("period_ms: 20", "period_ms: \u0662\u0660", "period_ms is '\u0662\u0660' in the header"),
        ("-0.300000,", "-57.3,", "line 12, column follower_2: -57.3 rad is beyond 8 rad; logs are in rad"),
        ("0.200000,", "8.001,", "line 12, column leader_1: 8.001 rad is beyond 8 rad"),
        (",15.000,", ",15000,", "line 12, column voltage_2: 15000 V is beyond 33 V; logs are in V"),
        ("greywhale log 1", "greywhale log 2", 'is a "greywhale log 2", but this greywhale reads "greywhale log 1"'),
        ("voltage_3", "volts_3", "line 11: column voltage_3 is missing"),
        ("parameter_crc: 0xbeef", "parameter_crc: beef", "parameter_crc is 'beef' in the header"),
        ("dropped_samples: 0", "dropped_samples: -1", "dropped_samples is '-1' in the header"),
        ("recording: complete", "recording: perhaps", "recording is 'perhaps' in the header"),
    ],
)
def test_a_spoiled_log_is_refused_by_line_and_column(tmp_path: Path, old: str, new: str, words: str) -> None:
    with pytest.raises(UserError) as caught:
        changed(tmp_path, old, new)
    assert str(tmp_path / "log.csv") in caught.value.message
    assert words in caught.value.message


def test_a_log_of_another_tool_needs_no_header(path: Path) -> None:
    row = ",".join(["0"] * 12) + ",disabled"
    path.write_text(f"{HEADING}\n0,{row}\n1,{row}\n")
    log = read_log(path)
    assert (log.origin, log.dropped, log.complete, log.condition.check) == (Origin(), 0, True, Check.UNCHECKED)


# --- long logs, a block at a time -----------------------------------------------------------------------------------


@pytest.fixture
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(csv_file, "BLOCK_BYTES", 1000)


@given(st.lists(samples, min_size=2, max_size=30))
def test_rows_parsed_at_once_are_those_of_float(rows: list[tuple[int, tuple[int, ...], tuple[int, ...], str]]) -> None:
    """Bit for bit, signs of zero included."""
    lines, numbers, states = [], [], []
    for tick, (_, angles, volts, state) in enumerate(rows):
        cells = [
            f"{tick / 1000:.6f}",
            *(f"{one / 4096:.6f}" for one in angles),
            *(f"{one / 1000:.3f}" for one in volts),
        ]
        lines.append(",".join([*cells, state]) + "\n")
        numbers.append([float(cell) for cell in cells])
        states.append(STATES.index(state))
    parsed = parse_rows("".join(lines).encode())
    assert parsed is not None
    assert parsed[0].tobytes() == np.array(numbers).tobytes()
    assert parsed[1].tolist() == states


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"0.100000", b"0.10:000"),
        (b"0.100000", b"0-100000"),
        (b"0.100000", b"-"),
        (b"0.100000", b""),
        (b"0.100000", b"0_1"),
        (b"0.100000", "١".encode()),
        (b"0.100000", b"\xa00.100000"),
        (b"following", b"followinG"),
        (b"following", b"following\r"),
        (b"following", b"following\0"),
        (b"following", b"soft_starting"),
        (b"following", b""),
        (b",", b";"),
        (b",", b",,"),
        (b"\n", b",\n"),
    ],
)
def test_rows_in_any_other_form_are_left_to_the_cells(old: bytes, new: bytes) -> None:
    row = b"0.001000," + b"0.100000," * 8 + b"-1.000," * 4 + b"following\n"
    rows = row + row.replace(b"0.001", b"0.002")
    assert parse_rows(rows) is not None
    assert parse_rows(rows.replace(old, new, 1)) is None


@pytest.mark.usefixtures("small_blocks")
def test_a_log_in_many_blocks_is_the_same(path: Path) -> None:
    write(path, 50)
    log = read_log(path)
    assert np.array_equal(log.time, np.arange(50) / 200)
    assert np.array_equal(log.leader, np.tile(ROW[0], (50, 1)))
    assert np.array_equal(log.voltage, np.tile(ROW[2], (50, 1)))
    assert log.condition.check is Check.WHOLE
    assert np.array_equal(log.follower, np.tile(ROW[1], (50, 1)))


@pytest.mark.usefixtures("small_blocks")
def test_a_bad_cell_in_a_later_block_is_named_by_its_line(path: Path) -> None:
    write(path, 50)
    lines = path.read_text().splitlines(keepends=True)
    lines[40] = lines[40].replace("0.300000", "x")
    path.write_text("".join(lines))
    with pytest.raises(UserError, match="line 41, column leader_2: 'x' is not a number"):
        read_log(path)
    lines[40] = lines[11]
    path.write_text("".join(lines))
    with pytest.raises(UserError, match="line 41, column time_s: time must increase, but"):
        read_log(path)


def test_only_an_unfinished_log_may_end_in_the_middle_of_a_line(path: Path) -> None:
    write(path, 5)
    text = path.read_text()[:-30]
    path.write_text(text)
    with pytest.raises(UserError, match="line 16: the file ends in the middle of this line"):
        read_log(path)
    path.write_text(text.replace("recording: complete", "recording: unfinished"))
    assert len(read_log(path).time) == 4


def test_a_log_takes_no_more_memory_than_its_numbers(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(csv_file, "BLOCK_BYTES", 1 << 14)
    write(path, 20_000)
    read_log(path)  # what is loaded when it is first used is not the log's
    tracemalloc.start()
    log = read_log(path)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(log.time) == 20_000
    block = 40 * csv_file.BLOCK_BYTES  # what the parsing of one block takes
    assert most < 20_000 * (8 + 12 * 4) + 20_000 + block


@pytest.mark.parametrize("odd", [-0.0, 0.1234567, 1e-9])
def test_numbers_come_back_to_the_bit_also_where_they_are_no_whole_millionths(path: Path, odd: float) -> None:
    angles = np.array([-2.345678, 0.000001, 7.999999, 0.3])
    lines = [f"{row / 1000:.6f},{','.join(map(repr, 3 * angles.tolist()))},following\n" for row in range(9)]
    lines[4] = lines[4].replace("-2.345678", repr(odd), 1)
    path.write_text(HEADING + "\n" + "".join(lines))
    log = read_log(path)
    assert {name: isinstance(log.held(name), Packed) for name in QUANTITIES} == {
        "leader": False, "follower": True, "voltage": True,
    }  # fmt: skip
    wanted = np.tile(angles, (9, 1))
    assert log.follower.tobytes() == log.voltage.tobytes() == wanted.tobytes()
    wanted[4, 0] = odd
    assert log.leader.tobytes() == wanted.tobytes()
    part = log.part(slice(3, 6))
    assert part.leader.tobytes() == wanted[3:6].tobytes()
    assert part.held("follower")[1, 2] == 7.999999
    assert part.state.tolist() == ["following"] * 3


@given(st.text())
@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@example('Put "it", then\n# task: go;')
@example("\u676f\u5b50\u3092\u7f6e\u304f \u2028 \x85 \udc80,")
def test_a_task_comes_back_in_any_words_also_from_a_spreadsheet(tmp_path: Path, task: str) -> None:
    path = tmp_path / "log.csv"
    with LogWriter(path, replace(ORIGIN, task=task)) as log:
        for row in range(3):
            log.append(row * 0.005, *ROW)
    lines = path.read_text("ascii").splitlines()
    assert (read_log(path).origin, read_log(path).condition.check) == (log.origin, Check.WHOLE)
    with path.open("w", newline="") as file:
        csv.writer(file).writerows(csv.reader(lines))
    assert (read_log(path).origin, read_log(path).condition.check) == (log.origin, Check.WHOLE)


@pytest.mark.parametrize(
    ("words", "task"),
    [('"Fold it"', "Fold it"), ("Fold it, twice", "Fold it, twice"), ('"Fold it', '"Fold it'), ("7", "7"), ("", None)],
)
def test_a_person_may_write_the_task_into_a_log(tmp_path: Path, words: str, task: str | None) -> None:
    log = changed(tmp_path, "# dropped_samples", f"# task: {words}\n# dropped_samples")
    assert (log.origin.task, log.condition.check) == (task, Check.WHOLE)


def test_the_header_says_which_joints_are_in_use_where_not_all_are(path: Path) -> None:
    with LogWriter(path, Origin(joints=(0, 2))) as log:
        for row in range(3):
            log.append(row * 0.005, *ROW)
    assert "# joints_in_use: 0,2\n" in path.read_text()
    assert read_log(path).joints_in_use == (0, 2)
    path.write_text(path.read_text().replace("joints_in_use: 0,2", "joints_in_use: 0,7"))
    with pytest.raises(UserError, match=r"log\.csv: joints_in_use: '0,7' is no list of joints"):
        read_log(path)
    write(path)
    assert "joints_in_use" not in path.read_text()
    assert read_log(path).joints_in_use == (0, 1, 2, 3)
