"""The countdown before an arm moves by itself: on a terminal, never for a simulated arm there, and scripts say --yes.
On a page before every start of the motors by a verb.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from greywhale.base.errors import INTERRUPTED, UserError
from greywhale.base.telling import Telling
from greywhale.cli import countdown, entry, output
from greywhale.files.arm import default_arm
from greywhale.files.model import to_toml
from greywhale.protocol import schema
from greywhale.protocol.ports import Port
from tests.board.port_board import PortBoard
from tests.cli.test_signals_and_pipes import RUN


def on_a_terminal(monkeypatch: pytest.MonkeyPatch, answer: bool) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: answer)


def test_a_terminal_counts_three_seconds(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    waited: list[float] = []
    on_a_terminal(monkeypatch, True)
    warn = countdown.prepare_motion("/dev/arm", yes=False)
    assert warn is countdown.count_down
    countdown.count_down(waited.append)
    assert waited == [1.0, 1.0, 1.0]
    text = capsys.readouterr().err
    assert [f"in {left} s" in text for left in (3, 2, 1)] == [True] * 3


def test_a_script_must_say_yes(monkeypatch: pytest.MonkeyPatch) -> None:
    on_a_terminal(monkeypatch, False)
    with pytest.raises(UserError, match="clear its surroundings and say --yes") as caught:
        countdown.prepare_motion("/dev/arm", yes=False)
    assert caught.value.exit_code == 2
    assert countdown.prepare_motion("/dev/arm", yes=True) is not countdown.count_down


def test_a_simulated_arm_moves_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    on_a_terminal(monkeypatch, False)
    bench = Port("/dev/null", "bench", "mega", bench=True, usb=False)
    monkeypatch.setattr("greywhale.protocol.ports.find_ports", lambda: [bench])
    assert countdown.prepare_motion("/dev/null", yes=False) is not countdown.count_down


@pytest.mark.parametrize("verb", [["replay", "motion.csv"], ["record", "--excite"], ["commission"]])
def test_every_verb_that_moves_the_arm_asks(
    verb: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Refused before the port is opened, which would restart a board."""
    monkeypatch.chdir(tmp_path)
    Path("motion.csv").write_text("time_s,leader_0,leader_1,leader_2,leader_3\n0,0,0,0,0\n1,0,0,0,0\n")
    with PortBoard() as board:
        assert entry.run([*verb, "--port", board.port]) == 2
        assert board.requests == []
    assert "say --yes" in capsys.readouterr().err


@pytest.mark.timeout(60)
def test_ctrl_c_in_the_countdown_keeps_the_arm_still(tmp_path: Path) -> None:
    motion, log = tmp_path / "motion.csv", tmp_path / "log.csv"
    motion.write_text("time_s,leader_0,leader_1,leader_2,leader_3\n0,0,0,0,0\n1,0,0,0,0\n")
    terminal, theirs = os.openpty()
    with PortBoard() as board:
        command = [sys.executable, "-c", RUN, "replay", str(motion), "-o", str(log), "--port", board.port]
        with subprocess.Popen(command, stderr=theirs) as host:
            os.close(theirs)
            text = b""
            while b"moves by itself in 3 s" not in text:
                text += os.read(terminal, 1024)
            host.send_signal(signal.SIGINT)
        assert host.returncode == INTERRUPTED
        assert board.asked(schema.LeadRequest) == 0
    os.close(terminal)
    assert not log.exists()


class Counted:
    """A page for which verbs run; `stops` is the count at which a person stops one there."""

    def __init__(self, stops: int = 0) -> None:
        self.told: list[int] = []
        self._stops = stops

    def __call__(self, what: str, fraction: float, note: str = "") -> None: ...
    def tells(self, telling: Telling) -> None: ...

    def counts(self, left: int) -> None:
        self.told.append(left)
        if self._stops and left == self._stops:
            raise KeyboardInterrupt


def test_a_page_counts_three_seconds_on_the_bench_too(monkeypatch: pytest.MonkeyPatch) -> None:
    waited: list[float] = []
    page = Counted()
    countdown.warn_page(waited.append)  # without a page nothing is counted
    assert waited == []
    monkeypatch.setattr(output, "watcher", page)
    monkeypatch.setattr(countdown, "is_bench", lambda port: True)
    assert countdown.prepare_motion("/dev/arm", yes=False) is countdown.warn_page
    assert countdown.prepare_motion("/dev/arm", yes=True) is countdown.warn_page
    countdown.warn_page(waited.append)
    assert (waited, page.told) == ([1.0, 1.0, 1.0], [3, 2, 1, 0])


STARTS = (schema.EnableRequest, schema.LeadRequest)


@pytest.mark.parametrize("stops", [3, 1])
@pytest.mark.parametrize(
    "verb", [["replay", "motion.csv"], ["record", "--excite", "--budget", "1"], ["record", "--enable"], ["commission"]]
)
def test_who_stops_the_count_on_a_page_has_moved_nothing(
    verb: list[str], stops: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("motion.csv").write_text("time_s,leader_0,leader_1,leader_2,leader_3\n0,0,0,0,0\n1,0,0,0,0\n")
    monkeypatch.setattr(output, "watcher", page := Counted(stops))
    monkeypatch.setattr(countdown, "SECOND_S", 0.0)
    with PortBoard() as board:
        assert entry.run([*verb, "--port", board.port]) == INTERRUPTED
        assert [board.asked(start) for start in STARTS] == [0, 0]
    assert page.told == [*range(3, stops - 1, -1), 0]


def test_an_arm_file_of_another_board_is_doubted_before_the_arm_moves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The model of the log would be refused for it, minutes later."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(output, "watcher", Counted(3))
    arm = default_arm()
    other = arm.model_copy(update={"drive": arm.drive.model_copy(update={"supply": 12.0})})
    Path("other.toml").write_text(to_toml(other, {}).replace("[identification]\n", ""), encoding="utf-8")
    excite = ["record", "--excite", "--budget", "1", "--arm", "other.toml"]
    with PortBoard() as board:
        assert entry.run([*excite, "--port", board.port]) == INTERRUPTED
    said = capsys.readouterr().err
    assert "Warning: other.toml: its drive.supply is 12 V, but the board's supply_mv says 15 V; " in said
