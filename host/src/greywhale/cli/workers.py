"""What verbs that repeat something share: where it is computed, and the file that lets an interrupted study go on."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from greywhale.base.errors import MOST_WORKERS
from greywhale.base.study.choose import FORMS

Command = TypeVar("Command", bound=Callable[..., Any])


def executor_options(*names: str) -> Callable[[Command], Command]:
    """--executor and --workers, which `base.study.choose_workers` takes; `names` are other names of --workers."""

    def add(command: Command) -> Command:
        workers = click.option(
            "--workers",
            *names,
            "workers",
            type=click.IntRange(1, MOST_WORKERS),
            help="Processes here; without it, one for every processor.",
        )
        executor = click.option(
            "--executor",
            default="local",
            show_default=True,
            metavar="WHERE",
            help=f"Where it is computed: {FORMS}. The result is the same.",
        )
        return executor(workers(command))

    return add


def results_option(command: Command) -> Command:
    """--results, the file of `greywhale.base.study.run_study`."""
    return click.option(
        "--results",
        type=click.Path(path_type=Path),
        help="Keep here what is done; the same command goes on from it after Ctrl-C or a kill.",
    )(command)
