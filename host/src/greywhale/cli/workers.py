"""Options of verbs that repeat something: the number of processes, and the file to go on from."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from greywhale.base.errors import MOST_WORKERS

Command = TypeVar("Command", bound=Callable[..., Any])


def workers_option(*names: str) -> Callable[[Command], Command]:
    """--workers, which `base.study.choose_workers` takes; `names` are other names of it."""
    return click.option(
        "--workers",
        *names,
        "workers",
        type=click.IntRange(1, MOST_WORKERS),
        help="Processes; without it, one for every processor. The result is the same.",
    )


def results_option(command: Command) -> Command:
    """--results, the file of `greywhale.base.study.run_study`."""
    return click.option(
        "--results",
        type=click.Path(path_type=Path),
        help="Keep here what is done; the same command goes on from it after Ctrl-C or a kill.",
    )(command)
