"""The countdown before an arm moves by itself: on a terminal, never for a simulated arm, and scripts say --yes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.cli import countdown, entry
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
        assert host.returncode == entry.INTERRUPTED
        assert board.asked(schema.LeadRequest) == 0
    os.close(terminal)
    assert not log.exists()
