"""A system without what Windows lacks: verbs without a board run, the others say what they need."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from greywhale.base.errors import FAILED

# A part of what Windows lacks. Locks on a file are those of this system, under the name that they have there.
LIKE_WINDOWS = """
import os, signal, subprocess, sys, types
for owner, names in (
    (os, "getuid geteuid major minor makedev pread killpg O_TMPFILE O_CLOEXEC O_NOFOLLOW O_DIRECTORY"),
    (signal, "SIGHUP SIGKILL SIGURG pthread_kill pthread_sigmask SIG_BLOCK SIG_UNBLOCK SIG_SETMASK"),
):
    for name in names.split():
        delattr(owner, name)
sys.modules.update(dict.fromkeys(("fcntl", "termios", "tty", "pty", "grp", "pwd", "resource")))
sys.modules["msvcrt"] = types.SimpleNamespace(LK_LOCK=os.F_LOCK, LK_NBLCK=os.F_TLOCK, locking=os.lockf)

from greywhale.cli.entry import run
print([run(words.split()) for words in sys.argv[1:]])
"""


def test_verbs_without_a_board_need_nothing_that_windows_lacks(tmp_path: Path) -> None:
    verbs = ("export --urdf default --out arm.urdf", "arm import arm.urdf --out arm.toml", "evaluate none.csv", "info")
    done = subprocess.run(
        [sys.executable, "-c", LIKE_WINDOWS, *verbs], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1] == str([0, 0, FAILED, FAILED])
    assert (tmp_path / "arm.toml").stat().st_size > 1000
    missing, refused = done.stderr.splitlines()
    assert missing.startswith("greywhale: none.csv: ")
    assert refused.startswith("greywhale: this verb needs termios, which Windows has not; use WSL 2")
