"""Signals and pipes as the command line meets them: each in a process of its own, never a traceback."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from greywhale.files.log import read_log
from greywhale.protocol import schema
from greywhale.protocol.schema import State
from tests.board.port_board import PortBoard
from tests.cli.example_log import write_log

pytestmark = pytest.mark.slow
RUN = """
import sys
from greywhale.board import device
device.Device.__init__.__defaults__ = (0.0, 0.5)
from greywhale.__main__ import main
main()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_ctrl_c_leaves_motors_off_and_the_log_whole(tmp_path: Path, number: signal.Signals) -> None:
    out = tmp_path / "log.csv"
    with PortBoard() as board:
        arguments = ["record", "--port", board.port, "-o", str(out), "-s", "600", "--enable", "--json"]
        process = subprocess.Popen(
            [sys.executable, "-c", RUN, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        board.wait_for(State.FOLLOWING, 300, process)
        process.send_signal(number)
        output, errors = process.communicate()
        assert board.state is State.DISABLED
        assert board.asked(schema.StopRequest) >= 1
    assert process.returncode == 130
    kept = f"interrupted. What was recorded is in {out}, marked as interrupted. The motors are off."
    assert json.loads(output) == {"error": kept, "exit_code": 130}
    assert "Traceback" not in errors
    log = read_log(out)
    assert not log.complete
    assert set(log.state) == {"following"}
    assert os.listdir(tmp_path) == ["log.csv"]


def test_a_reader_that_goes_away_is_no_traceback(tmp_path: Path) -> None:
    write_log(tmp_path / "log.csv")
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(
        [sys.executable, "-c", RUN, "evaluate", str(tmp_path / "log.csv")],
        stdout=write,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    os.close(write)
    assert done.returncode == 1
    assert done.stderr == ""


def closed(*numbers: int) -> Callable[[], None]:
    def close() -> None:
        for number in numbers:
            os.close(number)

    return close


@pytest.mark.parametrize("numbers", [(1,), (0, 1, 2)])
def test_closed_streams_are_nobodys(numbers: tuple[int, ...]) -> None:
    """`greywhale info >&-`: what is printed must not end up in the port, which would get the free number."""
    with PortBoard() as board:
        command = [sys.executable, "-c", RUN, "info", "--port", board.port]
        done = subprocess.run(command, preexec_fn=closed(*numbers), capture_output=True, text=True, check=False)
        assert board.problem is None
        asks = (schema.HelloRequest, schema.StatusRequest, schema.ParamGetRequest, schema.TelemetryRequest)
        assert {kind for kind, _ in board.requests} <= {request.TYPE for request in asks}
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
