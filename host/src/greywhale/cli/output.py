"""What all verbs share: --json, --port, and progress bars."""

from __future__ import annotations

import contextlib
import json
import logging
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, Protocol, TypeVar

import click
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from greywhale.cli import completion
from greywhale.errors import printable

WHOLE = 10_000  # parts of a progress bar
logger = logging.getLogger(__name__)
Command = TypeVar("Command", bound=Callable[..., Any])


class Report(Protocol):
    """Takes what is being done, the share of it that is done and, where it helps, how good the result is so far."""

    def __call__(self, what: str, fraction: float, note: str = "") -> None: ...


def json_option(command: Command) -> Command:
    return click.option("--json", "as_json", is_flag=True, help="Print exactly one JSON object on stdout.")(command)


def overwrite_option(command: Command) -> Command:
    """For every verb that writes files; `files.outputs.require_new` takes it."""
    return click.option("--overwrite", is_flag=True, help="Write over files that are there already.")(command)


def port_option(command: Command) -> Command:
    return click.option(
        "--port",
        "-p",
        envvar="GREYWHALE_PORT",
        metavar="PORT",
        shell_complete=completion.ports,
        help="Serial port of the board; without it, the only board found. [env: GREYWHALE_PORT]",
    )(command)


def show(as_json: bool, result: Mapping[str, Any], text: str) -> None:
    """Print the result of a verb: for programs or for people."""
    if as_json:
        click.echo(json_of(result))
    else:
        click.echo(printable(text))


def warn(sentences: Iterable[str]) -> None:
    """Tell people at once what they should know before they go on."""
    for sentence in sentences:
        click.echo(printable(f"Warning: {sentence}"), err=True)


def json_of(result: Mapping[str, Any]) -> str:
    """One line of JSON, readable in every language, that no terminal obeys: JSON itself escapes not all controls."""
    text = json.dumps(result, ensure_ascii=False)
    return text if text.isprintable() else json.dumps(result)


@contextlib.contextmanager
def progress(as_json: bool) -> Iterator[Report | None]:
    """A bar on stderr with the time left; None with --json or without a terminal, unless the steps are logged."""
    console = Console(stderr=True)
    steps = Steps() if logger.isEnabledFor(logging.INFO) else None
    if as_json or not sys.stderr.isatty() or not console.is_terminal:
        yield steps
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        TextColumn("left"),
        TextColumn("{task.fields[note]}"),
    )
    with Progress(*columns, console=console, transient=True) as bars:
        tasks: dict[str, TaskID] = {}

        def report(what: str, fraction: float, note: str = "") -> None:
            if what not in tasks:
                for done in tasks.values():
                    bars.update(done, completed=WHOLE)
                # What was done at the beginning shows nothing about the speed.
                tasks[what] = bars.add_task(what, total=WHOLE, completed=round(WHOLE * fraction), note=note)
            bars.update(tasks[what], completed=WHOLE * fraction, note=note)
            if steps is not None:
                steps(what, fraction, note)

        yield report


class Steps:
    """Logs the steps of a verb, each when it begins."""

    def __init__(self) -> None:
        self._what = ""
        self._begun = 0.0

    def __call__(self, what: str, fraction: float, note: str = "") -> None:
        if what != self._what:
            now = time.monotonic()
            if self._what:
                logger.info("%s: took %.3f s", self._what, now - self._begun)
            logger.info("%s", what)
            self._what, self._begun = what, now
