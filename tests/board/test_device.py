"""The device against a board that misbehaves: every way ends in an answer or in one sentence, with the motors off."""

from __future__ import annotations

import errno
import math
import os
import signal
from pathlib import Path
from typing import Self

import pytest
import serial

from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.greeting import NoAnswerError
from greywhale.board.limits import PATIENCE
from greywhale.board.refusal import RefusedError
from greywhale.protocol import schema
from greywhale.protocol.frames import encode_frame
from greywhale.protocol.schema import Fault, NackCode, Refusal, State
from greywhale.protocol.transport import PortDisturbedError
from tests.board.fake_board import FakeBoard, Faults, open_device, served
from tests.board.port_board import PortBoard, opened


@pytest.mark.timeout(60)
def test_nothing_is_sent_before_the_firmware_is_heard() -> None:
    # The Mega's bootloader would stay for seconds if it saw a byte. Without end, the quiet time can only be ended by
    # the board's own hello.
    board = FakeBoard()
    board.faults.chatter = board.own_hello()
    with board, Device(board.port, quiet_s=math.inf) as device:
        assert board.asked(schema.HelloRequest) == 1
        assert device.status().state is State.DISABLED
    assert board.asked(schema.StopRequest) == 0, "no motor ran"


def test_lost_answers_are_asked_for_again_under_the_same_number() -> None:
    with served() as (board, device):
        board.faults.lose[schema.ParamSetRequest.TYPE] = 4
        reply = device.ask(schema.ParamSetRequest(0, 5))
        assert (reply.index, reply.value) == (0, 5)
        numbers = [seq for kind, seq in board.requests if kind == schema.ParamSetRequest.TYPE]
        assert len(numbers) == 5
        assert len(set(numbers)) == 1


def test_a_board_that_falls_silent_is_named() -> None:
    with served() as (board, device):
        board.faults.silent = True
        with pytest.raises(NoAnswerError, match=rf"^{board.port}: .*status, sent 5 times"):
            device.status()
        assert board.asked(schema.StatusRequest) == 5


class InItsBootloader(FakeBoard):
    """Another program has left it there; the firmware runs after a restart."""

    def open(self, restart: bool, baud: int) -> Self:
        self.faults.silent = not restart
        return super().open(restart, baud)


def test_a_board_that_is_silent_without_a_restart_is_restarted() -> None:
    with InItsBootloader() as board:
        open_device(board).close()
        with Device(board.port, quiet_s=0.0, patience_s=0.5, restart=False) as device:
            assert device.restarted
            assert device.status().state is State.DISABLED


class Sleepy(FakeBoard):
    """Its host stands still each time that it has asked for something, for longer than it waits for an answer."""

    asleep = False

    def write(self, data: bytes) -> None:
        super().write(data)
        if self.asleep:
            self.wait(0.5)


def test_an_answer_that_waited_while_this_host_stood_still_is_heard() -> None:
    with Sleepy() as board, open_device(board) as device:
        board.asleep = True
        assert device.status().state is State.DISABLED
        assert board.asked(schema.StatusRequest) == 1


def test_answers_to_earlier_requests_are_not_taken_for_this_one() -> None:
    with served() as (board, device):
        stale = schema.StatusReply(
            *(State.FOLLOWING, schema.StopReason.NONE, Fault.NONE, 255, 0, 0, 0, 0, 0, 0, 0, schema.SaveState.IDLE, 0),
            schema.Clutch.ENGAGED,
        )
        board.say(encode_frame(schema.StatusReply.TYPE, 200, stale.pack()))
        assert device.status().state is State.DISABLED


def test_sequence_numbers_wrap_without_the_number_of_unasked_hellos() -> None:
    with served() as (board, device):
        for _ in range(260):
            device.status()
        numbers = [seq for kind, seq in board.requests if kind == schema.StatusRequest.TYPE]
        assert 0 not in numbers
        assert numbers[:3] == [2, 3, 4]
        assert len(set(numbers)) == 255


@pytest.mark.parametrize(
    ("faults", "words"),
    [
        (Faults(silent=True), "nothing answers.*greywhale flash --port"),
        (Faults(silent=True, chatter=b"Hello from some other sketch\r\n"), "no greywhale firmware answers"),
        (Faults(hello=bytes([9, 1])), f"protocol version 9, this host version {schema.PROTOCOL};"),
        (Faults(hello=bytes([schema.PROTOCOL, 1, 2])), "3 bytes"),
    ],
    ids=["silent", "another sketch", "another protocol", "a short hello"],
)
def test_who_is_no_board_of_ours_is_told(faults: Faults, words: str) -> None:
    with FakeBoard(faults) as board, pytest.raises(UserError, match=f"^{board.port}: .*{words}"):
        Device(board.port, quiet_s=0.1, patience_s=0.5)


def test_other_schema_names_both_hashes_and_the_firmware() -> None:
    with FakeBoard() as board:
        payload = bytearray(board.hello())
        payload[1:8] = bytes([3, 2, 1]) + (0x11223344).to_bytes(4, "little")
        board.faults.hello = bytes(payload)
        with pytest.raises(UserError, match=rf"firmware 3\.2\.1 .*0x11223344.*{schema.SCHEMA_HASH:#010x}; flash"):
            open_device(board)


@pytest.mark.parametrize(
    ("code", "detail", "words"),
    [
        (NackCode.OUT_OF_RANGE, schema.PARAMETER_BY_NAME["joint2.kp"].index, "joint2.kp"),
        (NackCode.OUT_OF_RANGE, 9999, "index 9999"),
        (NackCode.SET_REFUSED, 3 << 8 | Refusal.WIDTH, "joint 3, a flank of a fuzzy set is narrower than 0.01"),
        (NackCode.NOT_DISABLED, State.FOLLOWING, "state following"),
        (NackCode.ERROR_TOO_LARGE, 1 << 8 | 64, "joint 1, 2.00 rad"),
        (NackCode.ERROR_TOO_LARGE, 1 << 8 | 255, "7.97 rad or more"),
        (NackCode.IN_FAULT, Fault.TRACKING, Fault.TRACKING.description),
        (NackCode.POT_BAD, 5 << 8 | Fault.POT_LOW, "(follower potentiometer 1, at the lower rail)"),
        (NackCode.POT_BAD, 2 << 8 | Fault.POT_HIGH, "(leader potentiometer 2, at the upper rail or on another's wire)"),
    ],
)
def test_refusals_say_what_where_and_the_remedy(code: NackCode, detail: int, words: str) -> None:
    with served() as (board, device):
        board.faults.refuse[schema.EnableRequest.TYPE] = (code, int(detail))
        with pytest.raises(RefusedError) as caught:
            device.enable(500)
    remedy = Refusal.WIDTH.remedy if code is NackCode.SET_REFUSED else code.remedy
    assert caught.value.message.startswith(f"{board.port}: the board refused the request 'enable': {code.description}")
    assert words in caught.value.message
    by_verb = remedy.replace("clear the fault", "clear the fault (`greywhale stop --clear-fault`)")
    assert by_verb[1:] in caught.value.message


def test_leaving_stops_motors_that_an_error_left_on() -> None:
    with FakeBoard() as board:
        with pytest.raises(ZeroDivisionError), open_device(board) as device:
            device.enable(0)
            assert board.state is State.SOFT_START
            raise ZeroDivisionError
        assert board.state is State.DISABLED
        assert board.asked(schema.StopRequest) > 0


def test_enabled_stops_on_ctrl_c_and_after_a_refusal() -> None:
    with served() as (board, device):
        with pytest.raises(KeyboardInterrupt), device.enabled(500):
            raise KeyboardInterrupt
        assert board.state is State.DISABLED
        board.faults.lose[schema.EnableRequest.TYPE] = 99  # the motors run, but the host does not learn it
        with pytest.raises(NoAnswerError), device.enabled(500):
            pass
        assert board.state is State.DISABLED


class Pressed(FakeBoard):
    """A person presses Ctrl-C when this board is asked to stop for the first time."""

    pressed = False

    def write(self, data: bytes) -> None:
        if data.startswith(b"\0") and not self.pressed:
            self.pressed = True
            os.kill(os.getpid(), signal.SIGINT)
        super().write(data)


def test_a_ctrl_c_while_a_verb_stops_the_motors_itself_keeps_it_from_starting_them_again() -> None:
    with Pressed() as board, open_device(board) as device:
        with pytest.raises(KeyboardInterrupt):
            for _ in range(3):
                with device.enabled(500):
                    board.live()
        assert board.state is State.DISABLED
        assert (board.asked(schema.EnableRequest), device.status().state) == (1, State.DISABLED)


def test_an_unconfirmed_stop_is_told_with_the_error() -> None:
    with served() as (board, device):
        with pytest.raises(ZeroDivisionError) as caught, device.enabled(700):
            board.faults.silent = True
            raise ZeroDivisionError
        assert "within 700 ms" in caught.value.__notes__[0]


def test_an_unconfirmed_stop_without_lease_says_what_to_do() -> None:
    with served() as (board, device):
        device.enable(0)
        board.faults.silent = True
        with pytest.raises(UserError, match="switch the motors' supply off"):
            device.stop()


class SlowlyRead(FakeBoard):
    """A look at it takes a little longer than a stop waits for its answer, as one at a port of the system does."""

    def read(self) -> bytes:
        if not (taken := super().read()):
            self.wait(PATIENCE.stop_repeat_s)
        assert self.clock() < 60.0
        return taken


def test_an_unconfirmed_stop_ends_at_a_port_that_is_slow_to_say_nothing() -> None:
    with SlowlyRead() as board, open_device(board) as device:
        device.enable(500)
        board.faults.silent = True
        begin = board.clock()
        with pytest.raises(UserError, match="within 500 ms"):
            device.stop()
        assert board.clock() < begin + 3.5


def test_a_restart_during_a_request_is_named() -> None:
    with served() as (board, device):
        board.faults.silent = True
        board.say(board.own_hello())
        with pytest.raises(UserError, match="restarted.*the reset pin"):
            device.status()


def test_wrong_telemetry_echo_is_noticed() -> None:
    with served() as (board, device):
        board.faults.replies[schema.TelemetryRequest.TYPE] = schema.TelemetryReply(3).pack()
        with pytest.raises(UserError, match="every 3 ticks instead of 4"):
            device.telemetry(4)


def test_ports_that_cannot_be_opened(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="there is no such port"):
        Device(str(tmp_path / "ttyNONE"))
    plain = tmp_path / "file"
    plain.write_text("")
    with pytest.raises(UserError, match="not a serial port"):
        Device(str(plain))
    with pytest.raises(UserError, match="not a serial port"):
        Device(str(tmp_path))
    with PortBoard() as board, open_device(board), pytest.raises(UserError, match="in use by this program itself"):
        Device(board.port)


def test_the_terminal_is_not_taken_for_a_port(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither as /dev/tty nor by its number: it would be set to another speed under a person's hands."""
    with pytest.raises(UserError, match="^/dev/tty: this is a terminal"):
        Device("/dev/tty")
    with PortBoard() as board, monkeypatch.context() as patch:
        terminal = os.stat(board.port)
        patch.setattr(os, "isatty", lambda stream: stream == 2)
        patch.setattr(os, "fstat", lambda stream: terminal)
        with pytest.raises(UserError, match="this is a terminal"):
            Device(board.port)


@pytest.mark.parametrize(
    ("number", "words"),
    [
        (errno.EACCES, "usermod -aG dialout"),
        (errno.EBUSY, "in use by another program"),
        (errno.ENODEV, "no such port any more"),
        (errno.EIO, "cannot be opened: input/output error"),
    ],
)
def test_open_errors_have_their_remedies(
    number: int, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(serial, "Serial", refuse)
    port = tmp_path / "ttyX"
    port.touch()
    with pytest.raises(UserError, match=words) as caught:
        Device(str(port))
    assert caught.value.message.startswith(f"{port}: ")


def test_a_silent_board_with_a_second_program_at_its_port_is_not_blamed() -> None:
    with PortBoard() as board, Device(board.port, quiet_s=0.0) as device, opened(board.port) as process:
        board.faults.silent = True
        with pytest.raises(PortDisturbedError, match=rf"^{board.port}: another program, process {process} "):
            device.status()
        board.faults.silent = False
        assert device.status().state is State.DISABLED, "who only has the port open does no harm"


def test_a_second_reader_does_not_keep_the_stop_from_the_board(monkeypatch: pytest.MonkeyPatch) -> None:
    def steal(*_: object) -> bytes:
        raise serial.SerialException("multiple access on port?")

    with PortBoard() as board, Device(board.port, quiet_s=0.0) as device:
        with pytest.raises(PortDisturbedError) as caught, device.enabled(0):
            with monkeypatch.context() as patch:
                patch.setattr(serial.Serial, "read", steal)
                device.status()
        assert not getattr(caught.value, "__notes__", []), "the stop was confirmed"
    assert board.state is State.DISABLED
