"""Plain words on the terminal, and commands whose output is shown only when they fail."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from tools import ROOT

LOG = ROOT / "build" / "setup.log"


class SetupError(Exception):
    """One sentence: what failed and what to do."""


def say(text: str) -> None:
    print(f"set-up: {text}", flush=True)


def run(command: Sequence[str | Path], *, what: str, env: Mapping[str, str] | None = None, cwd: Path = ROOT) -> None:
    """Run a command with its output in build/setup.log; when it fails show the end of that output and stop."""
    LOG.parent.mkdir(parents=True, exist_ok=True)
    words = [str(word) for word in command]
    with LOG.open("ab+") as log:
        log.write(f"\n$ {' '.join(words)}\n".encode())
        log.flush()
        start = log.tell()
        full_env = {**os.environ, **(env or {})}
        status = subprocess.run(words, cwd=cwd, env=full_env, stdout=log, stderr=subprocess.STDOUT, check=False)
        if status.returncode == 0:
            return
        log.seek(start)
        output = log.read().decode(errors="replace").splitlines()
    print("\n".join(output[-60:]), file=sys.stderr, flush=True)
    raise SetupError(f"{what} failed (exit code {status.returncode}); the last lines are above, all of it is in {LOG}.")
