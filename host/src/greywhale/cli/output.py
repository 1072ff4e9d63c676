"""The options and output that all verbs share: --json, --port, results and progress."""

from __future__ import annotations

import contextlib
import json
import logging
import shlex
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Protocol, TypedDict, TypeVar

import click

from greywhale.base.errors import MOST_WORKERS, printable, require_between
from greywhale.base.telling import Step, Telling, told
from greywhale.base.types import NotedProgress, show_no_progress
from greywhale.cli import completion, tracing
from greywhale.cli.group import command_of
from greywhale.cli.wrapping import fit

ANSWER = "answer"  # attribute of a verb's function: the type of what it prints with --json
QUIET = "greywhale.quiet"  # in the context's `meta`: whether --quiet was said
logger = logging.getLogger(__name__)
Command = TypeVar("Command", bound=Callable[..., Any])
FILE = click.Path(path_type=Path)
# For every verb that writes files; `files.outputs.require_new` takes it.
overwrite_option = click.option("--overwrite", is_flag=True, help="Write over files that are there already.")
port_option = click.option(
    "--port",
    "-p",
    envvar="GREYWHALE_PORT",
    metavar="PORT",
    shell_complete=completion.ports,
    help="Serial port of the board; without it, the only board found. [env: GREYWHALE_PORT]",
)


class Watcher(NotedProgress, Protocol):
    """A page for which a verb runs, in the place of a terminal: it gets the reports, and what else a terminal shows."""

    def counts(self, left: int) -> None:
        """The arm moves in so many seconds; 0: it is no longer counted."""

    def tells(self, telling: Telling) -> None:
        """The result for people, of which the terminal makes text."""


watcher: Watcher | None = None


class OnPort(TypedDict):
    port: str  # the serial port that was used


def option(*names: str, **settings: Any) -> Callable[[Command], Command]:
    """click's option, whose help says the default."""
    return click.option(*names, show_default="default" in settings, **settings)


def json_option(answer: object) -> Callable[[Command], Command]:
    """--json; `answer` is the type of what it prints, or module:name of one whose import takes a moment."""

    def add(command: Command) -> Command:
        setattr(command, ANSWER, answer)
        return click.option("--json", "as_json", is_flag=True, help="Print exactly one JSON object on stdout.")(command)

    return add


def require_supply(volts: float) -> None:
    """Refuse a supply that no motor has that an Arduino drives."""
    require_between("--supply", volts, "V", (1.0, 60.0))


def workers_options(*names: str) -> Callable[[Command], Command]:
    """--workers and --scheduler, which `base.study.choose_workers` takes; `names` are other names of --workers."""
    workers = option(
        "--workers",
        *names,
        "workers",
        type=click.IntRange(1, MOST_WORKERS),
        help="Processes; without it, one for every processor. The result is the same.",
    )
    scheduler = option(
        "--scheduler",
        metavar="ADDRESS",
        help="A Dask scheduler whose workers do it instead, tls://HOST:PORT; needs greywhale[cluster]. The result is "
        "the same.",
    )
    return lambda command: workers(scheduler(command))


def show(as_json: bool, result: Mapping[str, object], telling: Telling | str) -> None:
    """Print the result of a verb: for programs or for people. A page gets both."""
    if isinstance(telling, str):
        telling = told(*telling.split("\n"))
    if watcher is not None:
        watcher.tells(telling)
    if as_json:
        click.echo(json_of(result))
    else:
        # A pipe gets the result alone.
        steps = [(f"Next: {_typed(step)}", 0) for step in telling.steps] if sys.stdout.isatty() else []
        click.echo("\n".join(fit(printable(line), sys.stdout, hang) for line, hang in [*telling.lines(), *steps]))


def _typed(step: Step) -> str:
    """The step as one types it."""
    command = command_of(click.get_current_context().find_root().command, step.verb)
    options: list[str] = []
    places: list[str] = []
    for parameter in command.params:
        given = step.given.get(parameter.name or "")
        if given is None:
            continue
        texts = [str(one) for one in (given if isinstance(given, list | tuple) else [given])]
        if isinstance(parameter, click.Option):
            name = max(parameter.opts, key=len)
            options += [name] if parameter.is_flag else [word for text in texts for word in (name, text)]
        else:
            places += texts
    return f"greywhale {step.verb} {shlex.join([*places, *options])}".rstrip()


def tell(text: str) -> None:
    """A note for the person: on stderr, where a terminal gets it between its borders."""
    click.echo(fit(printable(text), sys.stderr), err=True)


def warn(sentences: Iterable[str]) -> None:
    """Tell people at once what they should know before they go on."""
    for sentence in sentences:
        tell(f"Warning: {sentence}")


def json_of(result: Mapping[str, object]) -> str:
    """One line of JSON, readable in every language, that no terminal obeys: JSON itself escapes not all controls.

    A dataclass in it becomes an object of its fields.
    """
    text = json.dumps(result, ensure_ascii=False, default=vars)
    return text if text.isprintable() else json.dumps(result, default=vars)


@contextlib.contextmanager
def progress(brief: bool = False) -> Iterator[NotedProgress]:
    """Show the running step on stderr; with --quiet nobody looks, unless the steps are logged.

    Without a terminal the steps of a `brief` verb, which takes seconds, are not told one by one. With --json all is
    the same: that is about stdout.
    """
    if watcher is not None:
        yield watcher
        return
    steps = Steps() if logger.isEnabledFor(logging.INFO) else None
    context = click.get_current_context(silent=True)
    if context is not None and context.meta.get(QUIET):
        yield steps or show_no_progress
        return
    # What draws on a terminal takes a moment to import.
    from greywhale.cli.display import shown

    with shown(begins=not brief and not tracing.is_on_stderr()) as show_step:

        def report(what: str, fraction: float, note: str = "") -> None:
            if steps is not None:
                steps(what, fraction, note)
            show_step(what, fraction, note)

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
