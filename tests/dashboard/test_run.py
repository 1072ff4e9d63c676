"""A dashboard in a process of its own ends in good order, whatever tells it to: motors off, no traceback."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from greywhale.base.processes import start
from greywhale.protocol import schema
from tests.board.port_board import PortBoard
from tests.dashboard.browser import BoardSocket, Page

PATIENCE_S = 60.0
SERVE = """
import contextlib, sys
from pathlib import Path
from greywhale.dashboard import run, server
server.require_page = lambda: Path(".")
with contextlib.suppress(KeyboardInterrupt):
    ready = lambda access: print(access.address(), access.token, flush=True)
    run.serve(sys.argv[1], "default", Path("."), 0, list, ["false"], None, False, ready)
"""


@pytest.mark.slow
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGHUP], ids=lambda how: how.name)
def test_a_signal_turns_the_motors_off_and_ends_it(how: signal.Signals, tmp_path: Path) -> None:
    with PortBoard() as board:
        command = [sys.executable, "-c", SERVE, board.port]
        server = start(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        assert server.stdout is not None
        port, token = re.findall(r":(\d+)/#ticket=\S+ (\S+)", server.stdout.readline().decode())[0]
        with Page(int(port), token).open("/board") as socket:
            page = BoardSocket(socket)
            page.word("link", open=True)
            socket.say({"kind": "drive"})
            page.frame(schema.EnableReply.TYPE, page.ask(schema.EnableRequest(0)))
            server.send_signal(how)
            _, said = server.communicate(timeout=PATIENCE_S)
        assert (server.returncode, said.decode()) == (0, "")
        assert board.asked(schema.StopRequest) > 0
        assert board.state is schema.State.DISABLED
