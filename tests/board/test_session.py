"""A session that holds a port: another process or thread of the user may stop it, and nobody else; where they meet."""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import pytest

from greywhale.base import system
from greywhale.base.errors import UserError
from greywhale.base.runtime import VARIABLE
from greywhale.board import meeting
from greywhale.board.device import Device
from greywhale.board.limits import PATIENCE
from greywhale.board.meeting import Peer
from greywhale.board.record import record
from greywhale.board.session import NOTE, Session, StopAsked, ask_for_clutch, ask_to_stop
from greywhale.files.log import read_log
from greywhale.protocol import schema
from greywhale.protocol.schema import Clutch, State, StopReason
from tests.board.fake_board import open_device
from tests.board.port_board import PortBoard

STOPPED = {"pid": os.getpid(), "state": "disabled"}


def names(board: PortBoard) -> list[str]:
    """The names at which a session on the board may listen."""
    device = system.device_of(board.port)
    assert device is not None
    return meeting.names_of(device)


def connected(board: PortBoard) -> socket.socket:
    """A client of the board's session."""
    client = socket.socket(socket.AF_UNIX)
    client.connect(names(board)[0])
    return client


class Asker(threading.Thread):
    """Another terminal: asks for a stop as soon as it is told to, and keeps the answer."""

    def __init__(self, port: str) -> None:
        super().__init__()
        self._port = port
        self._now = threading.Event()
        self.answer: dict[str, Any] | None = None
        self.problem = ""

    def run(self) -> None:
        self._now.wait()
        try:
            self.answer = ask_to_stop(self._port)
        except UserError as error:
            self.problem = error.message

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


def stopped(board: PortBoard, name: str = "", meanwhile: Callable[[Device], None] | None = None) -> None:
    """A session on the board is stopped by who calls its port so."""
    with Asker(name or board.port) as other:
        with pytest.raises(KeyboardInterrupt), open_device(board) as device:
            if meanwhile is not None:
                meanwhile(device)
            other.ask()
            while True:
                device.samples()
        other.join()
    assert other.answer == STOPPED


def recorded(board: PortBoard, path: Path, report: Callable[[str, float], None]) -> None:
    with open_device(board) as device:
        record(device, path, 60.0, enable=True, progress=report)


def test_a_recording_ends_as_on_ctrl_c(tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    with PortBoard() as board, Asker(board.port) as other:
        with pytest.raises(KeyboardInterrupt) as caught:
            recorded(board, log, lambda what, fraction: other.ask(what, 1.0))
        other.join()
        assert board.stop_reason is StopReason.HOST
    assert other.answer == STOPPED
    assert NOTE in caught.value.__notes__
    assert not read_log(log).complete
    assert read_log(log).ended_by == NOTE
    assert ask_to_stop(board.port) is None, "the session is over"


def test_a_session_in_a_thread_ends_without_its_main_thread(tmp_path: Path) -> None:
    """As a server that serves more than one board."""
    ended: list[BaseException] = []

    def work(board: PortBoard) -> None:
        try:
            recorded(board, tmp_path / "log.csv", started)
        except KeyboardInterrupt as stop:
            ended.append(stop)

    recording = threading.Event()

    def started(what: str, fraction: float) -> None:
        if what == "recording":
            recording.set()

    with PortBoard() as board:
        worker = threading.Thread(target=work, args=(board,))
        worker.start()
        recording.wait()
        assert ask_to_stop(board.port) == STOPPED
        worker.join()
    assert isinstance(ended[0], StopAsked)


def test_no_motor_starts_after_a_stop() -> None:
    with PortBoard() as board, Asker(board.port) as other:
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
    with PortBoard() as board, Asker(board.port) as other:
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
    with PortBoard() as board, Asker(board.port) as other:

        def fall_silent(what: str, fraction: float) -> None:
            if what == "recording":
                board.faults.lose[schema.StopRequest.TYPE] = 10_000
                other.ask()

        with pytest.raises(KeyboardInterrupt):
            recorded(board, tmp_path / "log.csv", fall_silent)
        other.join()
    assert "within 500 ms" in other.problem


def test_an_interrupt_that_comes_just_before_a_long_wait_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Here the signal goes to another thread: the main thread's system call does not end by it, as in that race. The
    session holds a port now and then, as a commissioning that tunes: it must not move the arm any more.
    """
    kill = signal.pthread_kill

    def kill_without_waking(thread: int, number: int) -> None:
        kill(threading.get_ident() if number == signal.SIGINT else thread, number)

    monkeypatch.setattr(signal, "pthread_kill", kill_without_waking)
    before = signal.getsignal(signal.SIGURG)
    with PortBoard() as board, Asker(board.port) as other:
        with pytest.raises(KeyboardInterrupt) as caught, Session.of(board.port):
            with open_device(board):
                pass
            other.ask()
            threading.Event().wait()
        other.join()
    assert other.answer == {"pid": os.getpid(), "state": None}
    assert caught.value.__notes__ == [NOTE]
    assert signal.getsignal(signal.SIGURG) is before


@contextlib.contextmanager
def another(hold: Callable[[], AbstractContextManager[object]]) -> Iterator[int]:
    """A process that holds something, in an environment and a folder of its own; killed in the end."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.environ.update(dict.fromkeys(("XDG_RUNTIME_DIR", "TMPDIR", "HOME", VARIABLE), "/elsewhere"))
            os.chdir("/")
            with hold():
                os.write(writer, b"x")
                signal.pause()
        finally:
            os.kill(os.getpid(), signal.SIGKILL)
    os.close(writer)
    try:
        assert os.read(reader, 1) == b"x"
        yield child
    finally:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        os.close(reader)


def test_nobody_takes_the_port_of_another_session() -> None:
    """Also while that has it closed, as a commissioning that computes."""
    with PortBoard() as board:
        with (
            another(lambda: Session.of(board.port)) as child,
            pytest.raises(UserError, match=rf"^{board.port}: .* process {child} \(.*greywhale stop"),
        ):
            open_device(board)
        assert ask_to_stop(board.port) is None, "killed"
        with open_device(board) as device:
            assert device.status().state is State.DISABLED


def test_a_session_that_does_not_hear_is_told_with_the_switch_first() -> None:
    """After Ctrl-Z."""
    with PortBoard() as board, another(lambda: Session.of(board.port)) as child:
        os.kill(child, signal.SIGSTOP)
        os.waitpid(child, os.WUNTRACED)  # until it stands still
        with pytest.raises(UserError, match=rf"^Switch the motors' supply off: {board.port} .*`kill -9 {child}`"):
            ask_to_stop(board.port, heard_s=0.05)


def test_only_this_user_reaches_the_session(monkeypatch: pytest.MonkeyPatch) -> None:
    with PortBoard() as board, open_device(board) as device:
        monkeypatch.setattr(meeting, "peer_of", lambda connection: Peer(1, os.geteuid() + 1))
        with connected(board) as client:
            assert client.recv(64) == b"", "sent away unheard"
        assert device.status().state is State.DISABLED
        assert ask_to_stop(board.port) is None, "and a stranger is not asked"


def squat(monkeypatch: pytest.MonkeyPatch, names: list[str]) -> AbstractContextManager[int]:
    """Another user who took these names first."""

    @contextlib.contextmanager
    def take() -> Iterator[None]:
        with contextlib.ExitStack() as stack:
            for name in names:
                listener = stack.enter_context(socket.socket(socket.AF_UNIX))
                listener.bind(name)
                listener.listen()
            yield

    real, own = meeting.peer_of, os.getpid()

    def peer_of(connection: socket.socket) -> Peer:
        pid, uid = real(connection)
        return Peer(pid, uid if pid == own else 4711)

    monkeypatch.setattr(meeting, "peer_of", peer_of)
    return another(take)


def test_another_user_who_takes_a_name_first_hinders_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    with PortBoard() as board, squat(monkeypatch, names(board)[:-1]):
        stopped(board, meanwhile=lambda device: device.enable(0))


def test_no_motor_starts_where_nothing_could_stop_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(system, "in_foreground", lambda: False)
    with PortBoard() as board, squat(monkeypatch, names(board)) as child, open_device(board) as device:
        assert device.status().state is State.DISABLED, "to look is safe"
        for start in (device.enable, device.lead):
            with pytest.raises(UserError, match=rf"^{board.port}: .*process {child} of user 4711"):
                start(500)
        assert board.asked(schema.EnableRequest) == board.asked(schema.LeadRequest) == 0


def test_where_only_ctrl_c_stops_it_that_is_said_before_the_motors_start(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(system, "in_foreground", lambda: True)
    with PortBoard() as board, squat(monkeypatch, names(board)), open_device(board) as device:
        device.enable(500)
        device.enable(500)
    (warning,) = [record for record in caplog.records if record.levelno == logging.WARNING]
    assert "only Ctrl-C in this terminal stops the arm" in warning.getMessage()


def test_a_port_is_found_by_whatever_name(tmp_path: Path) -> None:
    with PortBoard() as board:
        (tmp_path / "arm").symlink_to(board.port)
        stopped(board, str(tmp_path / "arm"))
        assert board.asked(schema.StopRequest) > 0, "also where no motor was on"


def test_clients_that_say_nothing_hinder_nobody() -> None:
    with PortBoard() as board, contextlib.ExitStack() as stack:

        def crowd(device: Device) -> None:
            for _ in range(PATIENCE.most_clients + 3):
                stack.enter_context(connected(board))
                device.status()

        stopped(board, meanwhile=crowd)


def test_a_client_that_says_something_else_stops_nothing() -> None:
    with PortBoard() as board, open_device(board) as device, connected(board) as client:
        client.sendall(b"hello\n")
        assert client.recv(64) == b""
        assert device.status().state is State.DISABLED


def test_the_clutch_is_used_from_elsewhere_and_the_session_goes_on() -> None:
    with PortBoard() as board, open_device(board) as device:
        for action, becomes in (("disengage", Clutch.DISENGAGED), ("engage", Clutch.SHIFTED)):
            assert ask_for_clutch(board.port, action) == os.getpid()
            assert device.status().clutch is becomes
    assert ask_for_clutch(board.port, "engage") is None


def test_a_session_without_an_open_port_has_no_clutch_to_use() -> None:
    with PortBoard() as board, Session.of(board.port):
        with pytest.raises(UserError, match=r"has the port, but not open just now; try again in a moment\.$"):
            ask_for_clutch(board.port, "engage")


def test_a_client_that_does_not_wait_for_the_answer_is_heard() -> None:
    with PortBoard() as board, pytest.raises(KeyboardInterrupt), open_device(board) as device:
        with connected(board) as client:
            client.sendall(b"stop\n")
        while True:
            device.samples()


def test_the_names_are_the_users_own(monkeypatch: pytest.MonkeyPatch) -> None:
    ours = meeting.names_of("1:3")
    assert len(set(ours)) == meeting.NAMES_PER_PORT
    monkeypatch.setattr(os, "geteuid", lambda: 4711)
    assert not set(ours) & set(meeting.names_of("1:3"))
