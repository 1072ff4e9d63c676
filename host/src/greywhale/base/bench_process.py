"""A bench in a process of its own, so that a real serial port lies between it and this host.

The bench also takes commands on its standard input (a broken potentiometer, noise on the line, a power cut), and ends
when this process does.
"""

from __future__ import annotations

import contextlib
import json
import select
import subprocess
import sys
import tempfile
from typing import Any, Protocol

from greywhale.base import system
from greywhale.base.closing import Closing
from greywhale.base.errors import UserError
from greywhale.base.processes import start

ANSWER_WAIT_S = 60.0  # the machine may be busy; a healthy bench answers in milliseconds


class RunningBench(Protocol):
    """A running bench, in a process of its own or in this one (greywhale_sim.lockstep)."""

    @property
    def port(self) -> str: ...
    def command(self, text: str) -> dict[str, Any]: ...


class BenchProcess(Closing):
    """Starts `python -m greywhale_sim`, or another module that serves a bench; `port` is its serial port.

    The module must be installed, or its folder be on PYTHONPATH.
    """

    def __init__(self, *options: str, module: str = "greywhale_sim") -> None:
        if not system.WAITS_FOR_PIPES:
            raise UserError("no verb starts a bench on Windows; run `greywhale sim` and give other verbs its port.")
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 (close() closes it)
        self._process = start(
            [sys.executable, "-m", module, "--control", "--json", *options],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            start_new_session=True,  # Ctrl-C belongs to the host alone, which then ends the bench in good order
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._in, self._out = self._process.stdin, self._process.stdout
        try:
            self.port: str = self._answer()["port"]
        except BaseException:
            self.close()
            raise

    @property
    def exit_code(self) -> int | None:
        """The bench's exit code; None while it runs."""
        return self._process.poll()

    def command(self, text: str) -> dict[str, Any]:
        """Carry out one bench command, for example "power off", and return its answer."""
        try:
            self._in.write(text.encode() + b"\n")
            self._in.flush()
        except BrokenPipeError:
            raise self._ended() from None
        answer = self._answer()
        if "error" in answer:
            raise UserError(answer["error"])
        return answer

    def close(self) -> None:
        """End the bench, by force if it does not end when told to."""
        with contextlib.suppress(BrokenPipeError):  # it has ended already
            self._in.close()
        try:
            self._process.wait(timeout=10.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._out.close()
        self._errors.close()

    def _answer(self) -> dict[str, Any]:
        if not select.select([self._out], [], [], ANSWER_WAIT_S)[0]:
            raise UserError(f"the bench does not answer within {ANSWER_WAIT_S:g} s; stop it and try again.")
        line = self._out.readline()
        if not line:
            raise self._ended()
        answer: dict[str, Any] = json.loads(line)
        return answer

    def _ended(self) -> UserError:
        self._process.wait(timeout=10.0)
        self._errors.seek(0)
        lines = self._errors.read().decode("utf-8", "replace").strip().splitlines()
        reason = lines[-1].removeprefix("greywhale_sim: ") if lines else f"exit code {self._process.returncode}"
        return UserError(f"the bench ended: {reason}")
