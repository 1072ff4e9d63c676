"""Runs a build tool to its end: what it says is quoted when it fails."""

from __future__ import annotations

import contextlib
import re
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from greywhale.base import system
from greywhale.base.errors import UserError, os_reason
from greywhale.base.processes import start

GRACE_S = 5.0  # for a tool to end by itself
_PROBLEM = re.compile(r"error|failed|denied|timeout|cannot|can't", re.IGNORECASE)
_ESCAPE = re.compile(r"\x1b\[[0-9;]*[A-Za-z]")


@dataclass(frozen=True)
class Tool:
    """A command with the name people know it by, the folder that it runs in, and how long it may take."""

    name: str
    command: list[str]
    environment: dict[str, str]
    folder: Path
    limit_s: float


def run_tool(tool: Tool, look: Callable[[], None]) -> str:
    """Run to the end; all output. `look` is called again and again meanwhile, and may raise to end the tool."""
    try:
        process = start(
            tool.command,
            tool.environment,
            cwd=tool.folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,  # so that what the tool starts can be ended with it
        )
    except OSError as error:
        raise UserError(f"{tool.name} cannot be started: {tool.command[0]}: {os_reason(error)}.") from None
    with process:
        try:
            output = _wait(process, tool, look)
        except BaseException:
            _end(process)
            raise
    text = _ESCAPE.sub("", output.decode("utf-8", "replace"))
    if process.returncode != 0:
        problem = _problem(text).rstrip(".")
        raise UserError(f"{tool.name} failed with exit code {process.returncode}: {problem}.")
    return text


def _wait(process: subprocess.Popen[bytes], tool: Tool, look: Callable[[], None]) -> bytes:
    deadline = time.monotonic() + tool.limit_s
    while True:
        look()
        try:
            return process.communicate(timeout=0.1)[0]
        except subprocess.TimeoutExpired:
            if time.monotonic() > deadline:
                raise UserError(f"{tool.name} has not ended after {tool.limit_s:g} s; try again.") from None


def _end(process: subprocess.Popen[bytes]) -> None:
    """End the tool and everything it has started."""
    system.end_group(process.pid, by_force=False)
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(GRACE_S)
    system.end_group(process.pid, by_force=True)
    process.wait()


def _problem(text: str) -> str:
    """The line of the output that says most: the first that names a problem, else the last."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    for line in lines:
        if _PROBLEM.search(line):
            return line
    return lines[-1] if lines else "it said nothing"
