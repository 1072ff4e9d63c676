"""The words that start a bench, of `python -m greywhale_sim` and of a bench in this process."""

from __future__ import annotations

from collections.abc import Sequence

import click

from greywhale.cli import sim
from greywhale.cli.output import FILE
from greywhale_sim.lockstep import LockStepBench
from greywhale_sim.serve import ServeOptions

MORE = [  # than `greywhale sim` has, for programs
    click.Option(["--seed"], type=int, default=1, help="Of everything random."),
    click.Option(["--link"], type=FILE, help="A lasting name for the port."),
    click.Option(["--control"], is_flag=True, help="Take commands from standard input; its end ends the bench."),
]
COMMAND = click.Command("greywhale_sim", params=[*sim.command.params, *MORE], help="A bench behind a serial port.")


def read(words: Sequence[str]) -> tuple[ServeOptions, bool]:
    """The options that these words name, and whether the answer is JSON."""
    given = COMMAND.make_context("python -m greywhale_sim", list(words)).params
    as_json: bool = given.pop("as_json")
    return ServeOptions(**given), as_json


def lock_step(*words: str) -> LockStepBench:
    """A bench in this process that these words describe; its speed is that of whoever reads."""
    return LockStepBench(read(words)[0])
