"""A session that holds a port: another process or thread of the user may stop it, and nobody else."""

from __future__ import annotations

import os
import signal
import socket
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from greywhale.board.device import Device
from greywhale.board.record import record
from greywhale.board.session import NOTE, Session, StopAsked, ask_to_stop, socket_name
from greywhale.errors import UserError
from greywhale.files.log import read_log
from greywhale.protocol import schema
from greywhale.protocol.schema import State, StopReason
from greywhale.runtime import make_runtime_directory, runtime_directory
from tests.board.fake_board import FakeBoard, Faults


def open_device(board: FakeBoard) -> Device:
    return Device(board.port, quiet_s=0.0, patience_s=0.5)


class Asker(threading.Thread):
    """Another terminal: asks for a stop as soon as it is told to, and keeps the answer."""

    def __init__(self, port: str) -> None:
        super().__init__()
        self._port = port
        self._now = threading.Event()
        self.answer: dict[str, Any] | None = None
        self.problem = ""
        self.took_s = 0.0

    def run(self) -> None:
        self._now.wait()
        started = time.monotonic()
        try:
            self.answer = ask_to_stop(self._port)
        except UserError as error:
            self.problem = error.message
        self.took_s = time.monotonic() - started

    def __enter__(self) -> Asker:
        self.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._now.set()
        self.join()

    def ask(self, what: str = "recording", fraction: float = 1.0) -> None:
        """Also fit to be told the progress of a recording."""
        if what == "recording" and fraction > 0.1:
            self._now.set()


def recorded(board: FakeBoard, path: Path, report: Callable[[str, float], None]) -> None:
    with open_device(board) as device:
        record(device, path, 60.0, enable=True, progress=report)


def test_a_recording_ends_as_on_ctrl_c(tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    with FakeBoard() as board, Asker(board.port) as other:
        with pytest.raises(KeyboardInterrupt) as caught:
            recorded(board, log, lambda what, fraction: other.ask(what, 1.0))
        other.join()
        assert board.stop_reason is StopReason.HOST
    assert other.answer == {"pid": os.getpid(), "state": "disabled"}
    assert NOTE in caught.value.__notes__
    assert not read_log(log).complete
    assert read_log(log).ended_by == NOTE
    assert ask_to_stop(board.port) is None, "the session is over"


def test_it_ends_too_where_ctrl_c_is_ignored(tmp_path: Path) -> None:
    """As a script's background job runs."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with FakeBoard() as board, Asker(board.port) as other, pytest.raises(StopAsked):
            recorded(board, tmp_path / "log.csv", lambda what, fraction: other.ask(what, 1.0))
    finally:
        signal.signal(signal.SIGINT, before)
    assert other.answer == {"pid": os.getpid(), "state": "disabled"}


def test_a_session_in_a_thread_ends_without_its_main_thread(tmp_path: Path) -> None:
    """As a server that serves more than one board."""
    ended: list[BaseException] = []

    def work(board: FakeBoard) -> None:
        try:
            recorded(board, tmp_path / "log.csv", started)
        except KeyboardInterrupt as stop:
            ended.append(stop)

    recording = threading.Event()

    def started(what: str, fraction: float) -> None:
        if what == "recording":
            recording.set()

    with FakeBoard() as board:
        worker = threading.Thread(target=work, args=(board,))
        worker.start()
        assert recording.wait(30.0)
        assert ask_to_stop(board.port) == {"pid": os.getpid(), "state": "disabled"}
        worker.join()
    assert isinstance(ended[0], StopAsked)


def test_no_motor_starts_after_a_stop() -> None:
    with FakeBoard() as board, Asker(board.port) as other:
        with pytest.raises(KeyboardInterrupt), open_device(board) as device:
            other.ask()
            with pytest.raises(KeyboardInterrupt):
                while True:
                    device.status()
            for start in (device.enable, device.lead):
                with pytest.raises(StopAsked):
                    start(500)
            with pytest.raises(StopAsked):
                device.lead_point(0, (0, 0, 0, 0))
            raise KeyboardInterrupt
        assert board.asked(schema.EnableRequest) == board.asked(schema.LeadRequest) == 0


@pytest.mark.timeout(60)
def test_the_board_hears_the_stop_before_the_main_thread_does() -> None:
    """The main thread may be writing a file or computing."""
    with FakeBoard() as board, Asker(board.port) as other:
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
        try:
            with pytest.raises(StopAsked), open_device(board) as device:
                device.enable(0)
                other.ask()
                while board.stop_reason is not StopReason.HOST:
                    os.sched_yield()  # this thread does nothing for it
                assert board.state is State.DISABLED
                device.status()
        finally:
            signal.signal(signal.SIGINT, before)


def test_a_stop_that_is_not_confirmed_is_told(tmp_path: Path) -> None:
    with FakeBoard() as board, Asker(board.port) as other:

        def fall_silent(what: str, fraction: float) -> None:
            if what == "recording":
                board.faults.lose[schema.StopRequest.TYPE] = 10_000
                other.ask()

        with pytest.raises(KeyboardInterrupt):
            recorded(board, tmp_path / "log.csv", fall_silent)
        other.join()
    assert "not confirmed; the board stops by itself within 500 ms" in other.problem


def test_a_session_without_motors_is_stopped_as_well() -> None:
    with FakeBoard() as board, Asker(board.port) as other:
        with pytest.raises(KeyboardInterrupt), open_device(board) as device:
            other.ask()
            while True:
                device.samples()
        other.join()
        assert board.asked(schema.StopRequest) > 0
    assert other.answer == {"pid": os.getpid(), "state": "disabled"}


def test_what_holds_a_port_now_and_then_is_stopped_in_between() -> None:
    """As a commissioning that tunes: it must not move the arm any more."""
    with FakeBoard() as board, Asker(board.port) as other:
        with pytest.raises(KeyboardInterrupt) as caught, Session.of(board.port):
            with open_device(board):
                pass
            other.ask()
            threading.Event().wait()
        other.join()
    assert other.answer == {"pid": os.getpid(), "state": None}
    assert caught.value.__notes__ == [NOTE]


def test_an_interrupt_that_comes_just_before_a_long_wait_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Here the signal goes to another thread: the main thread's system call does not end by it, as in that race."""
    kill = signal.pthread_kill

    def kill_without_waking(thread: int, number: int) -> None:
        kill(threading.get_ident() if number == signal.SIGINT else thread, number)

    monkeypatch.setattr(signal, "pthread_kill", kill_without_waking)
    before = signal.getsignal(signal.SIGURG)
    with FakeBoard() as board, Asker(board.port) as other:
        with pytest.raises(KeyboardInterrupt), Session.of(board.port):
            other.ask()
            threading.Event().wait()
        other.join()
    assert other.answer == {"pid": os.getpid(), "state": None}
    assert signal.getsignal(signal.SIGURG) is before


def test_nobody_takes_the_port_of_another_session() -> None:
    with FakeBoard() as board:
        reader, writer = os.pipe()
        child = os.fork()
        if child == 0:
            with Session.of(board.port):
                os.write(writer, b"x")
                signal.pause()
        os.read(reader, 1)
        with pytest.raises(UserError, match=rf"^{board.port}: the port is in use by another greywhale.*greywhale stop"):
            open_device(board)
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        os.close(reader)
        os.close(writer)
        assert ask_to_stop(board.port) is None, "a killed session leaves its socket, but nobody listens"
        with open_device(board) as device:
            assert device.status().state is State.DISABLED


def test_only_this_user_reaches_the_socket() -> None:
    with FakeBoard() as board, open_device(board):
        path = runtime_directory() / socket_name(board.port)
        assert path.is_socket()
        assert path.parent.stat().st_mode & 0o077 == 0
    assert not path.exists()


def test_a_session_runs_without_a_folder_that_can_be_trusted() -> None:
    folder = make_runtime_directory()
    folder.chmod(0o777)
    try:
        with FakeBoard() as board, open_device(board) as device:
            assert device.status().state is State.DISABLED
            assert ask_to_stop(board.port) is None
    finally:
        folder.chmod(0o700)


def test_a_port_is_found_by_whatever_name(tmp_path: Path) -> None:
    with FakeBoard() as board, Asker(str(tmp_path / "arm")) as other:
        (tmp_path / "arm").symlink_to(board.port)
        with pytest.raises(KeyboardInterrupt), open_device(board) as device:
            other.ask()
            while True:
                device.samples()
        other.join()
    assert other.answer is not None


def test_a_client_that_says_nothing_stops_nothing() -> None:
    with FakeBoard(Faults()) as board, open_device(board) as device:
        with socket.socket(socket.AF_UNIX) as client:
            client.connect(str(runtime_directory() / socket_name(board.port)))
        assert device.status().state is State.DISABLED
