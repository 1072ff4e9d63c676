"""A recording whose port goes away: it waits, goes on after a stated gap, and never starts a motor."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.board import reconnect
from greywhale.board.device import Device
from greywhale.board.reconnect import record_through_losses
from greywhale.files.log import read_log
from greywhale.protocol import ports, schema
from greywhale.protocol.transport import LINES
from tests.board.fake_board import FakeBoard, Faults

Point = Callable[[FakeBoard], None]
NAME = "the board's lasting name"


@pytest.fixture
def point(monkeypatch: pytest.MonkeyPatch) -> Point:
    """Gives a board's port its lasting name, as udev does."""
    return lambda board: monkeypatch.setitem(LINES, NAME, board.open)


def lives(patch: pytest.MonkeyPatch, *boards: FakeBoard) -> None:
    """Let this machine's clock go with the boards', one after another, and with what is waited for in between."""
    waits: list[float] = []
    clock = SimpleNamespace(monotonic=lambda: sum(waits) + sum(board.clock() for board in boards), sleep=waits.append)
    patch.setattr(reconnect, "time", clock)


def opens(*before: Callable[[], None]) -> Callable[[str], Device]:
    """Opens a port; what is to happen just before the first time, the second time and so on."""
    steps = list(before)

    def open_device(port: str) -> Device:
        if steps:
            steps.pop(0)()
        return Device(port, quiet_s=0.0, patience_s=0.5)

    return open_device


def nothing() -> None:
    """As it is."""


def test_it_goes_on_after_a_stated_gap(out: Path, monkeypatch: pytest.MonkeyPatch, point: Point) -> None:
    with FakeBoard(Faults(unplug_at=300)) as first, FakeBoard() as second:
        lives(monkeypatch, first, second)
        point(first)
        steps = opens(nothing, nothing, nothing, lambda: point(second))  # it takes three attempts
        recording = record_through_losses(NAME, out, 3.0, open_device=steps)
        assert first.asked(schema.EnableRequest) == second.asked(schema.EnableRequest) == 0
        assert second.asked(schema.LeadRequest) == 0
    log = read_log(out)
    ((begin, length),) = recording.gaps
    assert log.complete
    steps_ms = np.diff(log.time) * 1000
    (place,) = np.flatnonzero(steps_ms > 1.5)
    assert log.time[place] == pytest.approx(begin, abs=1e-3)
    assert steps_ms[place] / 1000 == pytest.approx(length, abs=2e-3)
    assert length > 0.4, "s: two attempts in vain"
    assert log.dropped == recording.dropped == pytest.approx(1000 * length, abs=1)
    assert recording.duration_s == pytest.approx(3.0, abs=0.01)
    assert f"# gaps: 1: {length:g} s after {begin:g} s" in out.read_text(encoding="ascii")


def test_it_goes_away_twice(out: Path, monkeypatch: pytest.MonkeyPatch, point: Point) -> None:
    with FakeBoard(Faults(unplug_at=300)) as one, FakeBoard(Faults(unplug_at=200)) as two, FakeBoard() as three:
        lives(monkeypatch, one, two, three)
        point(one)
        steps = opens(nothing, lambda: point(two), lambda: point(three))
        recording = record_through_losses(NAME, out, 3.0, open_device=steps)
    assert len(recording.gaps) == 2
    assert read_log(out).complete


def test_a_port_that_stays_away_ends_the_log_whole(out: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with FakeBoard(Faults(unplug_at=300)) as board, pytest.raises(UserError, match="went away .* not come back"):
        lives(monkeypatch, board)
        record_through_losses(board.port, out, 1.0, open_device=opens())
    log = read_log(out)
    assert not log.complete
    assert "did not come back" in log.ended_by
    assert 200 < len(log.time) < 300
    assert os.listdir(tmp_path) == ["log.csv"]


def test_another_board_in_its_place_is_refused(out: Path, monkeypatch: pytest.MonkeyPatch, point: Point) -> None:
    with FakeBoard(Faults(unplug_at=300)) as first, FakeBoard() as other:
        lives(monkeypatch, first, other)
        other.running[schema.PARAMETER_BY_NAME["joint1.kp"].index] += 1
        point(first)
        steps = opens(nothing, lambda: point(other))
        with pytest.raises(UserError, match="another one"):
            record_through_losses(NAME, out, 5.0, open_device=steps)
    assert not read_log(out).complete


def test_a_port_without_a_loss_gives_the_log_of_an_ordinary_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with FakeBoard() as board:
        lives(monkeypatch, board)
        recording = record_through_losses(board.port, tmp_path / "log.csv", 0.5, open_device=opens())
    assert (recording.rows, recording.dropped, recording.gaps) == (500, 0, ())
    assert "# gaps: none" in (tmp_path / "log.csv").read_text(encoding="ascii")
    assert read_log(tmp_path / "log.csv").complete


def test_the_lasting_name_is_the_systems_where_it_has_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    device, folder = tmp_path / "ttyACM3", tmp_path / "by-id"
    device.touch()
    monkeypatch.setattr(ports, "LASTING", (folder,))
    assert ports.lasting_name(str(device)) == str(device)
    folder.mkdir()
    (folder / "usb-Arduino-if00").symlink_to(device)
    assert ports.lasting_name(str(device)) == str(folder / "usb-Arduino-if00")
    assert ports.lasting_name(str(folder / "usb-Arduino-if00")) == str(folder / "usb-Arduino-if00")
