"""A log for a page: a board's own samples again, whatever wrote the file, and only from the folder."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.dashboard import samples
from greywhale.dashboard.limits import SAMPLES
from greywhale.dashboard.samples import samples_of_log
from greywhale.files.log.layout import HEADING
from greywhale.protocol.schema import Sample, State


def row(time_s: float, leader: float = 0.0, voltage: float = 0.0, state: str = "following") -> str:
    return f"{time_s},{leader},0,0,-0.5,{leader},0,0,0,0,{voltage},0,0,{state}\n"


def told(path: Path, *rows: str) -> list[Sample]:
    path.write_text(f"{HEADING}\n{''.join(rows)}")
    data = samples_of_log(path)
    return [Sample.unpack(data[at : at + Sample.SIZE]) for at in range(0, len(data), Sample.SIZE)]


def test_a_row_is_the_sample_that_a_board_would_send(tmp_path: Path) -> None:
    first, second = told(tmp_path / "log.csv", row(7.5, 0.25, state="soft_start"), row(7.51, 1.0, -3.25))
    assert (first.tick, first.state, first.leader, first.follower) == (
        0, State.SOFT_START, (1024, 0, 0, -2048), (1024, 0, 0, 0)
    )  # fmt: skip
    assert (second.tick, second.state, second.voltage) == (10, State.FOLLOWING, (0, -3250, 0, 0))


def test_ticks_grow_and_what_no_board_counts_is_the_nearest(tmp_path: Path) -> None:
    rows = row(0.0), row(0.0004, 0.5), row(0.001, 8.0), row(0.0012, -8.0), row(0.0021, 8.0)
    found = told(tmp_path / "log.csv", *rows)
    assert [(one.tick, one.leader[0]) for one in found] == [(0, 2048), (1, -32768), (2, 32767)]


def test_what_is_too_long_for_a_page_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [row(0.001 * number) for number in range(4)]
    monkeypatch.setattr(samples, "SAMPLES", replace(SAMPLES, history=4))
    assert len(told(tmp_path / "log.csv", *rows)) == 4
    for name, most in (("SAMPLES", replace(SAMPLES, history=3)), ("MOST_LOG_BYTES", 100)):
        monkeypatch.setattr(samples, name, most)
        with pytest.raises(UserError, match=r"log\.csv: it is longer than the \d samples that a page shows"):
            told(tmp_path / "log.csv", *rows)
    monkeypatch.undo()
    with pytest.raises(UserError, match=r"log\.csv: it is longer"):
        told(tmp_path / "log.csv", row(0.0), row(5e6))
