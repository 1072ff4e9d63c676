"""Whoever cuts, patches or exchanges rows of a log is told, and nobody else is; so are its gaps."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from greywhale.base.errors import UserError
from greywhale.files.leader import load_leader
from greywhale.files.log import Log, LogWriter, read_evidence, read_log
from greywhale.files.log.check import Check, add_rows
from greywhale.files.log.condition import Gap, gaps_in
from greywhale.files.log.layout import Origin
from greywhale.files.log.reader import refuse_altered
from greywhale.protocol.table import ParameterTable

Rows = list[list[str]]


def write(path: Path, count: int = 300) -> None:
    """Every row is another, and the leader goes before the follower."""
    with LogWriter(path, Origin("1.2.3", "mega2560", 0xBEEF, 5, 5)) as log:
        for row in range(count):
            angle = 0.001 * row
            log.append(0.005 * row, [angle] * 4, [angle - 0.01] * 4, [0.1 * (row % 7)] * 4, "following")


def edited(path: Path, edit: Callable[[Rows], Rows]) -> Log:
    write(path)
    lines = path.read_text().splitlines()
    head = next(place for place, line in enumerate(lines) if line.startswith("time_s")) + 1
    rows = edit([line.split(",") for line in lines[head:]])
    path.write_text("\n".join([*lines[:head], *(",".join(cells) for cells in rows)]) + "\n")
    return read_log(path)


def with_line(path: Path, old: str, new: str) -> Log:
    """A log of which one line of the header is another."""
    write(path)
    text = path.read_text()
    (line,) = (line for line in text.splitlines() if line.startswith(f"# {old}"))
    path.write_text(text.replace(f"{line}\n", new))
    return read_log(path)


@st.composite
def damages(draw: st.DrawFn) -> Callable[[bytes], bytes]:
    """A byte or a row that is changed, removed, doubled, or exchanged with another."""
    how = draw(st.sampled_from(["change", "remove", "double", "exchange"]))
    of_rows = draw(st.booleans())
    one, other, byte = draw(st.integers(0, 999)), draw(st.integers(0, 999)), draw(st.integers(0, 255))

    def damage(data: bytes) -> bytes:
        parts = data.splitlines(keepends=True) if of_rows else [data[place : place + 1] for place in range(len(data))]
        a, b = one % len(parts), other % len(parts)
        if how == "change":
            parts[a] = parts[b] if of_rows else bytes([byte])
        elif how == "exchange":
            parts[a], parts[b] = parts[b], parts[a]
        else:
            parts[a] = b"" if how == "remove" else 2 * parts[a]
        return b"".join(parts)

    return damage


@pytest.fixture(scope="module")
def short_log(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("short") / "log.csv"
    write(path, 6)
    return path.read_bytes()


@given(damages())
@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_no_damage_to_rows_goes_unsaid(path: Path, short_log: bytes, damage: Callable[[bytes], bytes]) -> None:
    """By the readers of logs and of motions: they refuse the file, or say that it is not as it was recorded."""
    head, heading, rows = short_log.partition(b",state\n")
    damaged = damage(rows)
    assume(damaged != rows)
    path.write_bytes(head + heading + damaged)
    for read in (read_log, load_leader):
        try:
            remarks = read(path).remarks
        except UserError:
            continue
        assert any("as they were recorded" in remark for remark in remarks)


@pytest.mark.parametrize(
    "line",
    ["firmware: 9.9.9", "board: nano328", "parameter_crc: 0x1234", "period_ms: 4", "every_ticks: 6",
     "dropped_samples: 3", "recording: interrupted", "ended_by: a fault"],
)  # fmt: skip
def test_a_fact_that_was_changed_is_told(tmp_path: Path, line: str) -> None:
    log = with_line(tmp_path / "log.csv", line.partition(":")[0], f"# {line}\n")
    assert log.condition.check is Check.CHANGED


def test_a_fact_that_was_removed_or_added_is_told(path: Path) -> None:
    assert with_line(path, "firmware", "").condition.check is Check.CHANGED
    assert with_line(path, "board", "# board: mega2560\n# joints_in_use: 0\n").condition.check is Check.CHANGED
    assert with_line(path, "board", "# board: mega2560\n# board: nano328\n").condition.check is Check.CHANGED


def test_a_group_of_parameters_that_was_removed_is_told(tmp_path: Path) -> None:
    """Nothing else tells it: what a header lacks has its default, as in a log from before a parameter was added."""
    path, table = tmp_path / "log.csv", ParameterTable.defaults()
    with LogWriter(path, Origin(param_crc=table.crc, table=table)) as log:
        for row in range(2):
            log.append(row, [0.1] * 4, [0.1] * 4, [0.0] * 4, "following")
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join(line for line in lines if not line.startswith("# parameters.joint0:")))
    assert read_log(path).condition.check is Check.CHANGED


@pytest.mark.parametrize(
    "save",
    [
        lambda data: data.replace(b"\n", b"\r\n"),
        lambda data: b"\xef\xbb\xbf" + data,
        lambda data: data.replace(b"# board", b"# my arm, with the new gear: good\n# board"),
        lambda data: data.replace(b"# firmware: 1.2.3\n", b"").replace(b"# board", b"# firmware:1.2.3\n# board"),
    ],
    ids=["other ends of lines", "a mark of its encoding", "a comment", "other order"],
)
def test_what_editors_and_people_add_is_no_change(path: Path, save: Callable[[bytes], bytes]) -> None:
    write(path)
    path.write_bytes(save(path.read_bytes()))
    log = read_log(path)
    assert (log.condition.check, log.remarks) == (Check.WHOLE, ())


def test_the_check_is_what_the_page_says(tmp_path: Path) -> None:
    """The CRC-32 of the rows, then of the facts in the order of their names."""
    write(tmp_path / "log.csv", 4)
    head, _, rows = (tmp_path / "log.csv").read_text().partition(",state\n")
    facts = [line[2:].rstrip() for line in head.splitlines()[1:-2]]
    covered = "".join(f"{key}: {value.strip()}\n" for key, _, value in sorted(one.partition(":") for one in facts))
    assert f"# check: 4 rows, crc32 {zlib.crc32((rows + covered).encode()):08x}" in head


def test_an_older_log_is_read_and_said_to_have_no_check(tmp_path: Path) -> None:
    log = with_line(tmp_path / "log.csv", "check", "")
    assert log.condition.check is Check.UNCHECKED
    (remark,) = log.remarks
    assert remark.startswith(f"{tmp_path}/log.csv: it has no check")
    read_evidence(tmp_path / "log.csv")


@pytest.mark.parametrize(
    "check", ["300 rows", "crc32 12345678", "\u0663 rows, crc32 12345678", "3 rows, crc32 1234567g"]
)
def test_a_check_in_another_form_is_refused(tmp_path: Path, check: str) -> None:
    with pytest.raises(UserError, match=r"log\.csv: check is .* in the header"):
        with_line(tmp_path / "log.csv", "check", f"# check: {check}\n")


def test_results_rest_on_no_log_that_was_altered(path: Path) -> None:
    changed = edited(path, lambda rows: [*rows[:-1], [*rows[-1][:-1], "disabled"]])
    with pytest.raises(UserError, match=f"^{path}: its check fails.*`# check`"):
        refuse_altered(changed, Check.CHANGED)
    shortened = edited(path, lambda rows: rows[:200])
    refuse_altered(shortened, Check.CHANGED)
    with pytest.raises(UserError, match="only 200 of its 300 rows"):
        read_evidence(path)


def test_ctrl_c_between_a_write_and_its_check_loses_no_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []

    def interrupted(crc: int, lines: bytes) -> int:
        calls.append(len(lines))
        if sum(map(bool, calls)) == 2:  # the header was the first
            raise KeyboardInterrupt
        return add_rows(crc, lines)

    monkeypatch.setattr("greywhale.files.log.writer.add_rows", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write(tmp_path / "log.csv", 1000)
    log = read_log(tmp_path / "log.csv")
    assert (len(log.time), log.complete, log.condition.check) == (256, False, Check.WHOLE)


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
