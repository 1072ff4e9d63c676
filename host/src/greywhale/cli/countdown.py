"""Before the arm moves by itself: a countdown on the terminal, in which Ctrl-C and `greywhale stop` keep it still.

A simulated arm hurts nobody and moves at once. A script, which shows nobody a countdown, must say --yes.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import click

from greywhale.base.errors import BadUsage
from greywhale.protocol.ports import is_bench

SECONDS = 3
yes_option = click.option("--yes", "-y", is_flag=True, help="Move the arm without the countdown; scripts need this.")


def prepare_motion(port: str, yes: bool) -> Callable[[], None]:
    """What to call just before the arm on `port` moves by itself; refused at once where nobody would be warned."""
    if yes or is_bench(port):
        return lambda: None
    if not sys.stderr.isatty():
        raise BadUsage(
            "the arm would move by itself, and without a terminal nobody sees the countdown; clear its surroundings "
            "and say --yes."
        )
    return count_down


def count_down(wait: Callable[[float], None] = time.sleep) -> None:
    try:
        for left in range(SECONDS, 0, -1):
            click.echo(f"\rThe arm moves by itself in {left} s; Ctrl-C keeps it still. ", nl=False, err=True)
            wait(1.0)
    finally:
        click.echo(err=True)
