"""`greywhale info --watch`: a table that fits a small terminal, lines in a pipe, and nothing left running."""

from __future__ import annotations

import fcntl
import os
import pty
import struct
import subprocess
import sys
import termios
from dataclasses import replace

import numpy as np
import pytest

from greywhale.board.device import Device
from greywhale.board.upload import read_parameters
from greywhale.cli import entry
from greywhale.cli.watch import HEADING, SAMPLE_EVERY_TICKS, Look, as_line, as_table, looks
from greywhale.files.arm import load_arm
from greywhale.observe import Sight, Told
from greywhale.protocol import schema
from greywhale.protocol.schema import Fault, State
from tests.board.fake_board import FakeBoard, Faults
from tests.board.port_board import PortBoard
from tests.cli.test_signals_and_pipes import RUN
from tools import ROOT

Captured = pytest.CaptureFixture[str]
SAMPLE = schema.Sample(
    12_300, State.FOLLOWING, Fault.NONE, (4096, -4096, 0, 2048), (4055, -4096, 0, 0), (1500, 0, -3, 0)
)
MODEL = str(ROOT / "tests/observe/default_model.toml")
LOOK = Look("/dev/ttyACM0", 12_300, SAMPLE, np.arange(8), (), "", 0)


def test_a_table_says_what_there_is() -> None:
    lines = as_table(LOOK).splitlines()
    assert lines[0] == "/dev/ttyACM0, state following, 12.3 s since its start"
    assert lines[4].split() == ["joint", "0", "+1.000", "0", "+0.990", "4", "+0.010", "+1.50"]
    assert lines[7].split() == ["joint", "3", "+0.500", "3", "+0.000", "7", "+0.500", "+0.00"]
    assert "No fault." in lines


def test_a_table_says_what_pushes_from_outside_where_it_can_be_told() -> None:
    sights = np.array([Sight.TOLD, Sight.RESTING, Sight.IN_GAP, Sight.TOLD], dtype=np.uint8)
    sizes = np.array([0.5, 0.0, 0.0, -12.25]), np.array([0.25, 1.0, 1.0, 2.0])
    look = replace(LOOK, outside=Told(*sizes, sights, np.array([False, False, False, True])))
    lines = as_table(look).splitlines()
    assert [line[62:].strip() for line in lines[2:8]] == [
        *("outside", "N m", "+0.50 ±0.25", "at rest", "in its gap", "contact -12.25")
    ]
    assert max(map(len, lines)) <= 80
    assert as_line(look).split(",")[-12:] == ["0.500", "", "", "-12.250", "0.250", "", "", "2.000", "0", "0", "0", "1"]


def test_it_tells_torques_of_a_board_whose_motors_are_off(capsys: Captured) -> None:
    with FakeBoard() as board:
        assert entry.run(["info", "--watch", "--seconds", "0.2", "--model", MODEL, "--port", board.port]) == 0
        with Device(board.port, restart=False) as host:
            look = next(looks(host, read_parameters(host), load_arm(MODEL)))
            host.telemetry(0)
    heading, *lines = capsys.readouterr().out.splitlines()
    assert heading.endswith(",contact_3")
    assert lines
    assert all(line.count(",") == heading.count(",") for line in lines)
    assert look.outside is not None
    assert (look.outside.sight == Sight.OFF).all()


def test_in_a_pipe_a_line_each_second_and_at_a_fault(capsys: Captured) -> None:
    board = FakeBoard(Faults(followers=(0, 0, -10725, 0)))
    board.state, board.fault, board.fault_where = State.FAULT, Fault.POT_LOW, 6
    with board:
        assert entry.run(["info", "--watch", "--seconds", "2.5", "--port", board.port]) == 0
        assert board.asked(schema.EnableRequest) == 0
        with Device(board.port, restart=False) as host:
            assert host.status().state is State.FAULT
            look = next(looks(host, read_parameters(host)))
            host.telemetry(0)
    heading, *lines = capsys.readouterr().out.splitlines()
    assert heading == HEADING
    rows = [dict(zip(HEADING.split(","), line.split(","), strict=True)) for line in lines]
    assert [float(row["time_s"]) for row in rows] == pytest.approx([0.0, 1.0, 2.0], abs=SAMPLE_EVERY_TICKS / 1000)
    assert {(row["state"], row["fault"]) for row in rows} == {("fault", "pot_low")}
    assert look.fault.startswith("a potentiometer reads") or "rail" in look.fault
    assert [complaint[:24] for complaint in look.complaints] == ["follower potentiometer 2"]
    assert look.counts[6] == 0


def test_on_a_terminal_of_80_by_24_it_is_drawn_again_and_again() -> None:
    """In a process of its own, whose standard output is a terminal. Ctrl-C is its normal end."""
    outer, inner = pty.openpty()
    fcntl.ioctl(inner, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    with PortBoard() as board:
        command = [sys.executable, "-c", RUN, "info", "--watch", "--port", board.port]
        process = subprocess.Popen(
            command, stdout=inner, stderr=subprocess.PIPE, env=os.environ | {"TERM": "xterm", "NO_COLOR": "1"}
        )
        os.close(inner)
        shown = b""
        while shown.count(b"joint 3") < 3:
            shown += os.read(outer, 4096)
        process.send_signal(2)
        with pytest.raises(OSError, match="Input/output error"):  # its end of the terminal is closed
            while True:
                shown += os.read(outer, 4096)
        _, errors = process.communicate()
    os.close(outer)
    assert (process.returncode, errors) == (0, b"")
    assert b"state disabled" in shown
    assert b"\x1b[1A" in shown, "it goes back to the first line"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--watch", "--json"], "--watch goes on and on, and --json prints one object"),
        (["--seconds", "1"], "--seconds belongs to --watch"),
        (["--model", "m.toml"], "--model belongs to --watch"),
        (["--watch", "--seconds", "-1"], "-1.0 is not in the range"),
    ],
)
def test_what_does_not_go_together(arguments: list[str], words: str, capsys: Captured) -> None:
    assert entry.run(["info", *arguments, "--port", "/dev/none"]) == 2
    assert words in capsys.readouterr().err
