"""Tells what a command does: on stderr with -v and -vv, and in a file with --log-file, for a report of a bug.

Modules tell their steps to `logging`, as info or debug; without these options only warnings are told. The file is
opened for appending and takes a line at a time, so that it also says what a killed command was doing.
"""

from __future__ import annotations

import contextlib
import logging
import platform
import re
import sys
import time
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from greywhale.base.errors import BadUsage, os_reason, printable

ROOT = logging.getLogger("greywhale")
# What a line of the file begins with: local time with its offset.
LINE = re.compile(rb"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}[+-]\d{4} ")
PACKAGES = ("click", "numpy", "pydantic", "pyserial", "scipy")


logging.raiseExceptions = False  # a full disk or a closed terminal ends no command


class _Terminal(logging.Handler):
    """Writes to stderr as it is at that moment: a progress bar puts itself in its place."""

    def emit(self, record: logging.LogRecord) -> None:
        with contextlib.suppress(OSError, ValueError):
            sys.stderr.write(printable(self.format(record)) + "\n")


class _Lines(logging.Formatter):
    """Times with milliseconds and the offset of the time zone."""

    def formatTime(self, record: logging.LogRecord, datefmt: str | None = None) -> str:
        moment = time.localtime(record.created)
        return f"{time.strftime('%Y-%m-%dT%H:%M:%S', moment)}.{record.msecs:03.0f}{time.strftime('%z', moment)}"


def begin(verbose: int, file: Path | None) -> None:
    """Listen, at `verbose` 1 to the steps, at 2 to every request; a file gets all."""
    end()
    terminal = _Terminal((logging.WARNING, logging.INFO, logging.DEBUG)[min(verbose, 2)])
    terminal.setFormatter(logging.Formatter("%(name)s: %(message)s" if verbose else "greywhale: %(message)s"))
    ROOT.addHandler(terminal)
    if file is not None:
        ROOT.addHandler(_open(file))
    if verbose or file is not None:
        ROOT.setLevel(logging.DEBUG)


def tell_command(arguments: Sequence[str]) -> None:
    """Say what runs, and with what."""
    if ROOT.isEnabledFor(logging.INFO):
        ROOT.info("command: greywhale %s", printable(" ".join(arguments)))
        ROOT.info("greywhale %s, Python %s, %s", version("greywhale"), platform.python_version(), platform.platform())
        ROOT.debug("packages: %s", ", ".join(f"{name} {version(name)}" for name in PACKAGES))


def is_on_stderr() -> bool:
    """True if -v prints the steps there."""
    return any(isinstance(one, _Terminal) and one.level <= logging.INFO for one in ROOT.handlers)


def end() -> None:
    for handler in list(ROOT.handlers):
        ROOT.removeHandler(handler)
        with contextlib.suppress(OSError):  # a full disk
            handler.close()
    ROOT.setLevel(logging.NOTSET)


def _open(path: Path) -> logging.Handler:
    try:
        if path.is_file() and (head := path.read_bytes()[:64]) and not LINE.match(head):
            raise BadUsage(f"{path}: this is no log of --log-file; name another file.")
        file = logging.FileHandler(path, encoding="utf-8")
    except OSError as error:
        raise BadUsage(f"{path}: cannot be written: {os_reason(error)}.") from None
    file.setFormatter(_Lines("%(asctime)s %(levelname)s %(name)s: %(message)s"))
    return file
