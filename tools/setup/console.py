"""Plain words on the terminal, and commands whose output is shown only when they fail."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import suppress
from pathlib import Path
from typing import IO

from tools import ROOT

LOG = ROOT / "build" / "setup.log"
_order = threading.Lock()  # over the next two and the log
_started: list[subprocess.Popen[bytes]] = []
_stopped = threading.Event()


class SetupError(Exception):
    """One sentence: what failed and what to do."""


def say(text: str) -> None:
    print(f"set-up: {text}", flush=True)


def run(command: Sequence[str | Path], *, what: str, env: Mapping[str, str] | None = None, cwd: Path = ROOT) -> None:
    """Run a command with its output in build/setup.log; when it fails show the end of that output and stop."""
    words = [str(word) for word in command]
    with tempfile.TemporaryFile() as output:
        status = _status(words, {**os.environ, **(env or {})}, cwd, output)
        output.seek(0)
        said = output.read()
    with _order:
        LOG.parent.mkdir(parents=True, exist_ok=True)
        with LOG.open("ab") as log:
            log.write(f"\n$ {' '.join(words)}\n".encode() + said)
        if status == 0:
            return
        if not _stopped.is_set():
            print("\n".join(said.decode(errors="replace").splitlines()[-60:]), file=sys.stderr, flush=True)
    raise SetupError(
        f"{what} failed (exit code {status}): the last lines are above, all of it is in {LOG}; "
        "when the cause is mended, the same command goes on from there."
    )


def _status(words: list[str], env: Mapping[str, str], cwd: Path, output: IO[bytes]) -> int:
    # Beside others a command has its own process group, so that all it starts ends with it.
    group = None if threading.current_thread() is threading.main_thread() else 0
    with _order:
        if _stopped.is_set():
            raise SetupError("The set-up was stopped.")
        process = subprocess.Popen(
            words, env=env, cwd=cwd, stdout=output, stderr=subprocess.STDOUT, process_group=group
        )
        _started.append(process)
    try:
        return process.wait()
    except BaseException:  # Ctrl-C, where the command does not see it
        process.terminate()
        raise


def side_by_side(*branches: Callable[[], None]) -> None:
    """Do all of them at a time. When one fails, and at Ctrl-C, end what the others run; the first failure is told."""
    with ThreadPoolExecutor(len(branches)) as pool:
        try:
            for branch in as_completed([pool.submit(branch) for branch in branches]):
                branch.result()
        except BaseException:
            _stop()
            raise


def _stop() -> None:
    with _order:
        _stopped.set()
        for process in _started:
            if process.poll() is None:
                with suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGTERM)
