"""Runs a verb and ends the process: 0 done, 1 failed, 2 bad usage, 130 interrupted by Ctrl-C, SIGTERM or SIGHUP.

A failure is one sentence on stderr; with --json also {"error": ...} as the one object on stdout. Traceback is for bugs.
"""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import sys
import time
from collections.abc import Sequence
from io import TextIOWrapper
from types import FrameType
from typing import Annotated, NoReturn, TypedDict

import click

from greywhale.base import system
from greywhale.base.errors import (
    BAD_USAGE,
    FAILED,
    INTERRUPTED,
    LONGEST_SENTENCE,
    BadUsage,
    UserError,
    cut,
    os_reason,
    printable,
)
from greywhale.cli import tracing
from greywhale.cli.output import json_of
from greywhale.cli.verbs import greywhale
from greywhale.cli.wrapping import fit

logger = logging.getLogger(__name__)


ON_WINDOWS = "use WSL 2 (docs/your-arm.md), or the page in the browser, which has a bench inside."


class Failure(TypedDict):
    """The JSON that any verb prints with --json when it fails."""

    error: str  # one sentence: what is wrong, and what to do
    exit_code: Annotated[int, ("enum", [FAILED, BAD_USAGE, INTERRUPTED])]


def main() -> NoReturn:
    try:
        code = run(sys.argv[1:])
    except KeyboardInterrupt:  # before the verb, or after it
        code = INTERRUPTED
    for number in system.ENDING:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, signal.SIG_DFL)  # a handler's traceback while Python ends would be nobody's
    sys.exit(code)


def run(arguments: Sequence[str]) -> int:
    """Run the command line; its exit code."""
    _open_closed_streams()
    _print_in_any_encoding()
    if signal.getsignal(signal.SIGINT) is signal.SIG_DFL:  # as at the start, before a Ctrl-C could be answered
        signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, _terminated)
    if signal.getsignal(system.HANG_UP) is not signal.SIG_IGN:  # nohup means what it says
        signal.signal(system.HANG_UP, _terminated)
    begun = time.monotonic()
    try:
        code = _run(arguments, as_json="--json" in arguments)
        logger.info("exit code %d after %.3f s", code, time.monotonic() - begun)
        return code
    finally:
        tracing.end()


def _run(arguments: Sequence[str], as_json: bool) -> int:
    try:
        _refuse_empty(arguments)
        code = greywhale.main(list(arguments), prog_name="greywhale", standalone_mode=False, obj=list(arguments))
        sys.stdout.flush()
        return code if isinstance(code, int) else 0
    except UserError as error:
        return _failed(_with_notes(error.message, error), error.exit_code, as_json)
    except click.UsageError as error:
        return _failed(_usage_sentence(error), BAD_USAGE, as_json)
    except click.ClickException as error:
        return _failed(error.format_message(), error.exit_code, as_json)
    except (KeyboardInterrupt, click.Abort) as error:
        return _failed(_with_notes("interrupted.", error.__cause__ or error), INTERRUPTED, as_json)
    except ModuleNotFoundError as error:
        if error.name not in system.NOT_ON_WINDOWS:
            raise
        return _failed(f"this verb needs {error.name}, which Windows does not have; {ON_WINDOWS}", FAILED, as_json)
    except BrokenPipeError:
        # The reader of our output has gone. Nothing is left to say, and Python must not try to say it at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except OSError as error:
        named = f"{error.filename}: " if error.filename else ""
        return _failed(f"{named}{os_reason(error)}.", FAILED, as_json)


def _open_closed_streams() -> None:
    """Give what was closed (`>&-`) to nobody: else a port or a file would take the number, and get what is printed."""
    for number, name, mode in ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w")):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free number
            setattr(sys, name, open(number, mode, encoding="utf-8", closefd=False))  # noqa: SIM115 (until the end)


def _print_in_any_encoding() -> None:
    """Print a mark in the place of what the terminal's encoding lacks, as many lack "²": no report is lost for that."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # a notebook's and a test's are others
            stream.reconfigure(errors="replace")


def _refuse_empty(arguments: Sequence[str]) -> None:
    """Refuse an empty name, mostly of an unset shell variable: it would be taken for the current folder."""
    for before, argument in zip(["", *arguments], arguments, strict=False):
        if argument == "" or (argument.startswith("--") and argument.endswith("=")):
            option = argument.rstrip("=") or before
            named = f"the value of {option}" if option.startswith("-") else "an argument"
            raise BadUsage(f"{named} is empty; give one, or leave it out.")


def _terminated(number: int, frame: FrameType | None) -> None:
    """End a verb on SIGTERM, and on SIGHUP of a closed terminal, as Ctrl-C does: motors off, files whole."""
    raise KeyboardInterrupt


def _failed(message: str, code: int, as_json: bool) -> int:
    message = cut(message, LONGEST_SENTENCE)
    logger.info("failed: %s", printable(message))
    logger.debug("where:", exc_info=True)
    if as_json:
        answer: Failure = {"error": message, "exit_code": code}
        print(json_of(answer))
    with contextlib.suppress(OSError):  # the terminal may be gone
        print(fit(f"greywhale: {printable(message)}", sys.stderr), file=sys.stderr)
    return code


def _with_notes(message: str, error: BaseException) -> str:
    return " ".join([message, *getattr(error, "__notes__", ())])


def _usage_sentence(error: click.UsageError) -> str:
    message = " ".join(error.format_message().split())
    message += "" if message[-1:] in (".", "?") else "."
    return f"{message} Try `{error.ctx.command_path} --help`." if error.ctx else message
