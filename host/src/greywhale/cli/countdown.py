"""Before the arm moves by itself: a countdown, in which Ctrl-C, `greywhale stop` and a page's Stop keep it still.

On a terminal a simulated arm hurts nobody and moves at once, and a script, which shows nobody a countdown, must say
--yes. On a page every verb that starts the motors counts, on the bench too: a button says less than a command line.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import click

from greywhale.base.errors import BadUsage
from greywhale.cli import output
from greywhale.protocol.ports import is_bench

COUNTDOWN_SECONDS = 3  # to step back or press Ctrl-C
SECOND_S = 1.0  # shorter in tests
yes_option = click.option("--yes", "-y", is_flag=True, help="Move the arm without the countdown; scripts need this.")


def prepare_motion(port: str, yes: bool) -> Callable[[], None]:
    """The warning to call just before the arm on `port` moves by itself; BadUsage at once where nobody would see it."""
    if output.watcher is not None:
        return warn_page
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
        for left in range(COUNTDOWN_SECONDS, 0, -1):
            click.echo(f"\rThe arm moves by itself in {left} s; Ctrl-C keeps it still. ", nl=False, err=True)
            wait(SECOND_S)
    finally:
        click.echo(err=True)


def warn_page(wait: Callable[[float], None] = time.sleep) -> None:
    """Count on the page for which this verb runs, just before it starts the motors; a terminal shows nothing."""
    if output.watcher is None:
        return
    try:
        for left in range(COUNTDOWN_SECONDS, 0, -1):
            output.watcher.counts(left)
            wait(SECOND_S)
    finally:
        output.watcher.counts(0)
