"""The verb at a terminal: what a person types too early, wrongly or to end it, and what the board then has."""

from __future__ import annotations

import contextlib
import fcntl
import os
import pty
import signal
import struct
import subprocess
import sys
import termios
from collections.abc import Iterator
from pathlib import Path
from typing import Self

import numpy as np
import pytest

from greywhale.base.errors import INTERRUPTED, UserError
from greywhale.board.calibrate import Result
from greywhale.board.calibrate.solve import Calibration
from greywhale.board.device import Device
from greywhale.board.upload import read_parameters
from greywhale.cli import calibrate as verb
from greywhale.cli.entry import run
from greywhale.cli.story import BenchProcess
from greywhale.protocol.table import ParameterTable
from tools.support.calibrating_person import CalibratingPerson

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def bench() -> Iterator[BenchProcess]:
    with BenchProcess("--speed", "max") as started:
        yield started


class Session:
    """`greywhale calibrate` of joint 0 in a terminal of 80 x 24."""

    def __init__(self, port: str, folder: Path) -> None:
        self._screen, inner = pty.openpty()
        fcntl.ioctl(inner, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
        command = [sys.executable, "-m", "greywhale", "calibrate", "--port", port, "--joints", "0"]
        self.process = subprocess.Popen(command, cwd=folder, stdin=inner, stdout=inner, stderr=inner)
        os.close(inner)
        self._left = ""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.wait()
        os.close(self._screen)

    def until(self, words: str) -> str:
        """Everything that is printed until these words, whatever lines it was broken into."""
        while words not in " ".join(self._left.split()):
            piece = self._read()
            assert piece, f"{words!r} does not come; there is: {self._left}"
            self._left += piece
        before, _, self._left = " ".join(self._left.split()).partition(words)
        return before

    def end(self) -> str:
        """Everything that is printed until the end."""
        while piece := self._read():
            self._left += piece
        return " ".join(self._left.split())

    def enter(self, word: str = "") -> None:
        os.write(self._screen, f"{word}\n".encode())

    def _read(self) -> str:
        with contextlib.suppress(OSError):  # how a pseudo-terminal says that nothing more comes
            return os.read(self._screen, 65536).decode()
        return ""


def go_to_the_pulses(session: Session, person: CalibratingPerson) -> None:
    for sweep, side in enumerate(("leader", "follower"), 1):
        session.until(f"Sweep {sweep} of 2: {side} joint 0, base yaw.")
        person.do(f"turn {side} 0 0.5")
        session.enter()
    for pose, degrees in enumerate((0, 35, 0, -20), 1):
        session.until(f"Pose {pose} of 4")
        person.do(f"hold {degrees}")
        session.enter()
    session.until("Each motor now gets")
    person.do("hang")
    session.enter()
    session.until("Motor 1 of 1, joint 0, base yaw: pulses of 1.5 V")


def test_mistakes_and_early_keys_cost_nothing_and_only_a_yes_stores(bench: BenchProcess, tmp_path: Path) -> None:
    person = CalibratingPerson(bench)
    with Session(bench.port, tmp_path) as session:
        session.until("Sweep 1 of 2: leader joint 0, base yaw.")
        session.enter()
        session.until("did not move")
        session.until("mend it")
        session.enter()
        session.until("Sweep 1 of 2")
        session.enter("back")
        session.until("This is the first step.")
        go_to_the_pulses(session, person)
        session.enter()
        session.enter("yes")
        assert "limits [degrees]" in session.until("Store this? [yes or no]"), "the result is shown before the question"
        session.enter()
        session.until("Store this? [yes or no]")
        session.enter("yes")
        said = session.end()
    assert "Stored. To undo: greywhale params restore before-calibration.toml" in said
    assert session.process.returncode == 0
    assert run(["params", "restore", str(tmp_path / "before-calibration.toml"), "--port", bench.port]) == 0


def test_who_interrupts_a_pulse_leaves_the_board_as_it_was(bench: BenchProcess, tmp_path: Path) -> None:
    with Device(bench.port) as device:
        before = device.hello.param_crc
    writes = bench.command("status")["eeprom_writes"]
    with Session(bench.port, tmp_path) as session:
        go_to_the_pulses(session, CalibratingPerson(bench))
        session.process.send_signal(signal.SIGINT)
        assert session.end().endswith("greywhale: interrupted. Nothing was stored.")
        assert session.process.wait() == INTERRUPTED
    status = bench.command("status")
    assert not status["motors_enabled"]
    assert status["eeprom_writes"] == writes
    assert list(tmp_path.iterdir()) == []
    with Device(bench.port, restart=False) as device:
        assert device.hello.param_crc == before, "what ran before runs again, also without a restart"


def test_who_is_cut_off_while_it_is_stored_hears_how_to_undo_it(
    bench: BenchProcess, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def lose_the_board(device: Device, table: ParameterTable) -> None:
        raise UserError("the board has gone.")

    limits = np.tile([-1.5, 1.5], (4, 1))
    found = Calibration(np.full(8, 500.0), np.full(8, 0.005), limits)
    monkeypatch.setattr(verb, "calibrate", lambda device, *asked: Result(found, read_parameters(device), np.zeros(4)))
    monkeypatch.setattr(verb, "upload_set", lose_the_board)
    backup = tmp_path / "before.toml"
    assert run(["calibrate", "--yes", "--backup", str(backup), "--port", bench.port]) == 1
    assert capsys.readouterr().err == (
        "greywhale: the board has gone. The board may have the new parameters; to undo: greywhale params restore "
        f"{backup}\n"
    )
    assert backup.exists()
