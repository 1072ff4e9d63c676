"""Differences between systems: devices and terminals here, and a system that has only what Windows has."""

from __future__ import annotations

import os
import pty
import signal
import stat
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from greywhale.base import system
from greywhale.base.errors import FAILED

# Where greywhale has what it has on Windows, and other packages what they have here. Locks on a file are this system's,
# under their name on Windows. Every port that pyserial opens is another program's.
LIKE_WINDOWS = """
import asyncio, os, pkgutil, select, signal, socket, subprocess, sys, types
import serial, serial.tools.list_ports
import greywhale

for owner, names in (
    (os, "getuid geteuid getpgrp tcgetpgrp major minor makedev pread killpg setpriority fchdir set_blocking"),
    (os, "O_TMPFILE O_CLOEXEC O_NOFOLLOW O_DIRECTORY"),
    (signal, "SIGHUP SIGKILL SIGURG pthread_kill pthread_sigmask SIG_BLOCK SIG_UNBLOCK SIG_SETMASK"),
    (select, "poll"),
    (socket, "AF_UNIX SO_PEERCRED"),
):
    for name in names.split():
        delattr(owner, name)
sys.modules.update(dict.fromkeys(("fcntl", "termios", "tty", "pty", "grp", "pwd", "resource")))
sys.modules["msvcrt"] = types.SimpleNamespace(LK_LOCK=os.F_LOCK, LK_NBLCK=os.F_TLOCK, locking=os.lockf)
signal.SIGBREAK = signal.SIGUSR1

def refuse(port, *options, **named):
    raise serial.SerialException(f"could not open port {port!r}: PermissionError(13, 'Access is denied.', None, 5)")

serial.Serial = refuse
here, sys.platform = sys.platform, "win32"
from greywhale.base import sockets, system
sys.platform, sockets.sys = here, types.SimpleNamespace(platform="win32")
system.sys = sockets.sys
"""


def on_windows(program: str, *words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", LIKE_WINDOWS + program, *words]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)


def test_all_verbs_run_with_what_windows_has_or_say_what_they_need(tmp_path: Path) -> None:
    program = """
from greywhale.cli import verbs
from greywhale.cli.entry import run
for verb in verbs.all_verbs():
    pkgutil.resolve_name(verbs.place_of(verb))
print([run(words.split()) for words in sys.argv[1:]])
"""
    done = on_windows(
        program,
        "export --urdf default --out arm.urdf",
        "arm import arm.urdf --out arm.toml",
        "evaluate none.csv",
        "info --port COM7",
        "record --port COM77 --out log.csv",
        "calibrate --port arm",
        "demo",
        folder=tmp_path,
    )
    assert done.stdout.splitlines()[-1] == str([0, 0, *[FAILED] * 5])
    assert (tmp_path / "arm.toml").stat().st_size > 1000
    missing, *busy, no_port, starting, no_bench = done.stderr.splitlines()
    assert missing.startswith("greywhale: none.csv: ")
    assert [line.partition(" (")[0] for line in busy] == [
        f"greywhale: {port}: the port is in use by another program; close that" for port in ("COM7", "COM77")
    ]
    assert no_port.startswith("greywhale: arm: there is no such port")
    assert "starting the bench" in starting
    assert no_bench.startswith("greywhale: no verb starts a bench on Windows; run `greywhale sim`")


def test_no_motor_starts_on_windows_where_no_ctrl_c_could_stop_it(tmp_path: Path) -> None:
    program = """
from greywhale.base.errors import UserError
from greywhale.board.session import Session, ask_to_stop
try:
    with Session.of("com7") as session:
        assert ask_to_stop("COM7") is None
        session.refuse_motion()
except UserError as error:
    print(error)
"""
    told = on_windows(program, folder=tmp_path).stdout
    assert told.startswith(
        "com7: `greywhale stop` cannot reach this session, because this system has no abstract sockets"
    )
    assert "nor can the Ctrl-C of a terminal, so the motors stay off" in told


@pytest.mark.parametrize("terminal", [True, False])
def test_a_terminals_ctrl_c_is_known_to_reach_a_process(terminal: bool) -> None:
    reader, writer = os.pipe()
    child, master = pty.fork() if terminal else (os.fork(), reader)
    if child == 0:
        if not terminal:
            os.setsid()
        os.write(writer, str(system.in_foreground()).encode())
        os.kill(os.getpid(), signal.SIGKILL)
    os.waitpid(child, 0)
    assert os.read(reader, 8) == str(terminal).encode()
    for descriptor in {reader, writer, master}:
        os.close(descriptor)


def test_a_device_is_one_under_all_its_names(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to("/dev/null")
    assert system.device_of(str(tmp_path / "link")) == system.device_of("/dev/null") == "1:3"
    assert system.device_of("/dev/zero") == "1:5"


def test_what_is_no_device_has_none(tmp_path: Path) -> None:
    for name in (str(tmp_path), str(tmp_path / "none"), "bench in lock step", "a\0b"):
        assert system.device_of(name) is None


def test_a_pseudo_terminal_is_not_the_one_that_had_its_number_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """Else a session that is just ending would keep others from a new bench."""

    def made_at(time: int, major: int) -> str | None:
        found = SimpleNamespace(st_mode=stat.S_IFCHR | 0o620, st_rdev=os.makedev(major, 5), st_ctime_ns=time)
        with monkeypatch.context() as patch:
            patch.setattr(os, "stat", lambda name: found)
            return system.device_of("/dev/x")

    assert made_at(1, 136) != made_at(2, 136)
    assert made_at(1, 166) == made_at(2, 166), "but the owner of a real port may change while it is in use"
