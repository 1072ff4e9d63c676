"""An adaptation through the serial port: the set that is wished for runs, and nothing stays unasked.

What to decide is scripted here: the decisions themselves are tested without a board.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from greywhale.adapt import AdaptationRequest, AdaptationResult, adapt, store_kept
from greywhale.adapt import change as change_module
from greywhale.adapt import run as run_module
from greywhale.adapt.change import SOFT_START_MS
from greywhale.adapt.decide import Adaptation, Outcome, TriedSet, Wish
from greywhale.adapt.limits import ADAPTATION_LIMITS
from greywhale.adapt.propose import Task
from greywhale.adapt.stretch import Stretch
from greywhale.base.errors import UserError
from greywhale.base.study import SerialWorkers
from greywhale.board.device import Device
from greywhale.board.upload import apply_staged, read_parameters, run_set
from greywhale.files.arm import default_arm
from greywhale.files.controller import load
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.table import ParameterTable
from greywhale_sim.lockstep import LockStepBench
from tests.adapt.test_decide import stiffer
from tests.tune.models import write_model
from tools.support.person_at_work import working_bench

pytestmark = pytest.mark.slow
TABLE = ParameterTable.defaults()
SET = stiffer(1.3)
SECONDS = 5.0


class Scripted(Adaptation):
    """Wishes for SET after a second, and keeps it after a second with it."""

    def take(self, stretch: Stretch) -> None:
        if self.running is self.start:
            self.wish = Wish(self.start.with_controllers(SET), "a test")
        elif self.kept is self.start:
            self.kept = self.running
            tried = SET, self.kept.crc, stretch.begins_s, 0.8, Outcome.KEPT, "20 % less error", 1.0, 0.8, 0.7, 0.9
            self.trials.append(TriedSet(*tried))

    def task(self) -> Task | None:
        return None


@pytest.fixture
def bench() -> Iterator[LockStepBench]:
    """A leader that goes to and fro at the first joint, and rests in between."""
    times = np.arange(0.0, 20.0, 0.02)
    swing = 0.3 * np.clip(np.sin(2 * np.pi * times / 2.5), 0.0, None) ** 2
    made, _ = working_bench(Trajectory(times, swing[:, None] * [1.0, 0.0, 0.0, 0.0]), lambda _: default_arm())
    with made as running:
        yield running


@pytest.fixture
def ran(monkeypatch: pytest.MonkeyPatch) -> list[ParameterTable]:
    """The sets that the board was left to run, without storing them."""
    seen: list[ParameterTable] = []

    def spy(device: Device, table: ParameterTable, *report: object) -> None:
        run_set(device, table)
        seen.append(table)

    monkeypatch.setattr(run_module, "run_set", spy)
    monkeypatch.setattr(run_module, "Adaptation", Scripted)
    return seen


def work(
    bench: LockStepBench,
    folder: Path,
    look: Callable[[str], None] = lambda what: None,
    warn: Callable[[], None] = lambda: None,
) -> AdaptationResult:
    model = write_model(folder / "model.toml")
    request = AdaptationRequest(bench.port, model, folder / "adapted.toml", SerialWorkers(), seconds=SECONDS)
    return adapt(request, lambda what, fraction, note="": look(what), warn)


def stored(bench: LockStepBench) -> ParameterTable:
    """What the board runs after its next start, which opening its port is."""
    with Device(bench.port) as device:
        return read_parameters(device)


def test_who_stops_at_the_warning_has_moved_nothing(
    bench: LockStepBench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started: list[object] = []
    monkeypatch.setattr(Device, "enable", lambda *asked: started.append(asked))

    def stop() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        work(bench, tmp_path, warn=stop)
    assert started == []


def test_a_set_runs_from_a_rest_on_and_the_one_from_before_at_the_end(
    bench: LockStepBench, tmp_path: Path, ran: list[ParameterTable]
) -> None:
    result = work(bench, tmp_path)
    assert result.improved
    assert not result.stored
    assert result.changes == 1
    assert result.seconds == pytest.approx(SECONDS, abs=0.01)
    assert 0.0 <= result.bump_rad < ADAPTATION_LIMITS.changes.close_rad
    assert result.kept == TABLE.with_controllers(SET), "the soft start is the stored one"
    assert load(tmp_path / "adapted.toml").table() == result.kept
    assert ran == [TABLE]
    assert stored(bench) == TABLE
    assert not bench.command("status")["motors_enabled"]
    assert store_kept(bench.port, result).stored
    assert stored(bench) == result.kept
    assert "a set was kept: 20 % less error (20 % less predicted, 1 s)" in result.text()
    assert "those that were kept are in the file" in result.text()


def test_the_board_follows_with_the_set_on_trial(
    bench: LockStepBench, tmp_path: Path, ran: list[ParameterTable], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Read back from the board in the middle of the work."""
    read: list[ParameterTable] = []

    def look(device: Device, table: ParameterTable) -> None:
        apply_staged(device, table)
        read.append(read_parameters(device))

    monkeypatch.setattr(change_module, "apply_staged", look)
    work(bench, tmp_path)
    assert read == [TABLE.with_controllers(SET).with_raw({"soft_start_ms": SOFT_START_MS})]


def test_ctrl_c_leaves_the_set_from_the_start(bench: LockStepBench, tmp_path: Path, ran: list[ParameterTable]) -> None:
    def interrupt(what: str) -> None:
        if (tmp_path / "adapted.toml").exists():
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        work(bench, tmp_path, interrupt)
    assert ran == [TABLE]
    assert not bench.command("status")["motors_enabled"]
    assert stored(bench) == TABLE


def test_a_board_that_falls_silent_has_the_stored_set_after_its_next_start(
    bench: LockStepBench, tmp_path: Path, ran: list[ParameterTable]
) -> None:
    def cut(what: str) -> None:
        if (tmp_path / "adapted.toml").exists():
            bench.command("power off")

    with pytest.raises(UserError) as caught:
        work(bench, tmp_path, cut)
    assert any("after its next start" in note for note in caught.value.__notes__)
    bench.command("power on")
    assert stored(bench) == TABLE
