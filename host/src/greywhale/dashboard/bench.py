"""The simulated bench that a dashboard starts: a process behind its own serial port, told by lines what to do."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol, Self

from greywhale.base import processes
from greywhale.base.errors import UserError


class Hands(Protocol):
    """Whoever carries out a command of docs/bench.md and returns its answer; a bad one is a UserError."""

    def command(self, text: str) -> dict[str, Any]: ...


class BenchProcess:
    """A context: `python -m greywhale_sim` in real time. `port` is its serial port."""

    def __init__(self, arm: Path | None, board: str) -> None:
        words = ["--control", "--json", "--board", board, *(["--arm", str(arm)] if arm is not None else [])]
        self._process = processes.start(
            [sys.executable, "-m", "greywhale_sim", *words],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C ends it through this process, which turns the motors off first
        )
        self._lock = threading.Lock()
        self.port = str(self._answer().get("port"))

    def command(self, text: str) -> dict[str, Any]:
        """Carry out one command."""
        assert self._process.stdin is not None
        with self._lock:
            try:
                self._process.stdin.write(text.replace("\n", " ").encode() + b"\n")
                self._process.stdin.flush()
            except OSError:
                raise UserError("the bench has ended; start the dashboard again.") from None
            answer = self._answer()
        if "error" in answer:
            raise UserError(answer["error"])
        return answer

    def _answer(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        assert self._process.stderr is not None
        line = self._process.stdout.readline()
        if not line:
            said = self._process.stderr.read().decode("utf-8", "replace").strip().splitlines()
            raise UserError(said[-1].removeprefix("greywhale_sim: ") if said else "the bench has ended by itself.")
        answer: dict[str, Any] = json.loads(line)
        return answer

    def close(self) -> None:
        """The end of its standard input ends it."""
        for pipe in (self._process.stdin, self._process.stdout, self._process.stderr):
            assert pipe is not None
        self._process.communicate()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
