"""Runs a build tool with its output in a file: watched for progress, and quoted when the tool fails."""

from __future__ import annotations

import contextlib
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from greywhale.base import system
from greywhale.base.errors import UserError
from greywhale.base.processes import start
from greywhale.board.flash import guard

_GUARD = Path(guard.__file__)
_LOOK_EVERY_S = 0.1
GRACE_S = 5.0  # for a tool to end by itself
_PROBLEM = re.compile(r"error|not in sync|failed|denied|timeout|cannot|can't|mismatch|doesn't match", re.IGNORECASE)
# avrdude says this of every port that is no real UART, whatever happens next.
_HARMLESS = re.compile(r"\bioctl\b", re.IGNORECASE)
_NO_BOOTLOADER = re.compile(
    r"not in sync|stk500\w*getsync|timeout communicating|unable to open programmer|not responding", re.IGNORECASE
)
_ESCAPE = re.compile(r"\x1b\[[0-9;]*[A-Za-z]")


@dataclass(frozen=True)
class Tool:
    """A command with the name people know it by, how long it may take, and the port that it works on, if any.

    `folder` is where it runs, without one the current folder.
    """

    name: str
    command: list[str]
    environment: dict[str, str]
    limit_s: float
    port: str = ""
    folder: Path | None = None


def run_tool(tool: Tool, look: Callable[[str], None]) -> str:
    """Run to the end; all output. `look` sees the output so far, again and again, and may raise to end the tool. The
    output goes through a file, because a pipe that nobody empties in time would stop the tool. When this process is
    killed, the guard looks after the tool.
    """
    guarded = [sys.executable, "-I", "-S", str(_GUARD), str(tool.limit_s), tool.port, *tool.command]
    with tempfile.TemporaryFile() as output:  # without a name, so that a kill leaves none
        with start(
            guarded,
            tool.environment,
            cwd=tool.folder,
            stdin=subprocess.PIPE,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,  # so that what the tool starts can be ended with it
        ) as process:
            try:
                code = _wait(process, tool, output, look)
            except BaseException:
                _end(process)
                raise
        text = _read(output)
    if code == guard.CANNOT_START:
        raise UserError(f"{tool.name} cannot be started: {text.strip()}.")
    if code != 0:
        raise UserError(f"{tool.name} failed with exit code {code}: {_problem(text).rstrip('.')}{_remedy(text)}")
    return text


def _wait(process: subprocess.Popen[bytes], tool: Tool, output: IO[bytes], look: Callable[[str], None]) -> int:
    deadline = time.monotonic() + tool.limit_s
    while True:
        look(_read(output))
        try:
            return process.wait(_LOOK_EVERY_S)
        except subprocess.TimeoutExpired:
            if time.monotonic() > deadline:
                raise UserError(
                    f"{tool.name} has not ended after {tool.limit_s:g} s; reset the board and try again."
                ) from None


def _end(process: subprocess.Popen[bytes]) -> None:
    """End the tool and everything it has started: an avrdude left behind would hold the port and a processor."""
    system.end_group(process.pid, by_force=False)
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(GRACE_S)
    system.end_group(process.pid, by_force=True)
    process.wait()


def _read(output: IO[bytes]) -> str:
    """All that is there. The tool writes where this process would read: its place in the file is the same."""
    return _ESCAPE.sub("", system.read_all(output.fileno()).decode("utf-8", "replace"))


def _problem(text: str) -> str:
    """The line of the output that says most: the first that names a problem, else the last."""
    lines = [line.strip() for line in text.splitlines() if line.strip() and not _HARMLESS.search(line)]
    for line in lines:
        if _PROBLEM.search(line):
            return line
    return lines[-1] if lines else "it said nothing"


def _remedy(text: str) -> str:
    if not _NO_BOOTLOADER.search(text):
        return "."
    return "; no bootloader answered: check --board and the cable, press the board's reset button and try again."
