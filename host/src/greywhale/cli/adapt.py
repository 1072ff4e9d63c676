"""`greywhale adapt`: the controllers stay right while a person works with the arm."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from greywhale.base.errors import MOST_SEED
from greywhale.base.formats.whole import refuse_inputs
from greywhale.base.study import LocalWorkers
from greywhale.base.telling import Step, Telling
from greywhale.board.limits import RECORDING
from greywhale.cli.countdown import warn_page
from greywhale.cli.output import FILE, json_option, option, overwrite_option, port_option, progress, show, tell
from greywhale.files.outputs import require_new
from greywhale.protocol.ports import choose_port

if TYPE_CHECKING:
    from greywhale.adapt import AdaptationResult


@click.command("adapt")
@click.argument("model", type=FILE)
@option("--out", "-o", type=FILE, default="adapted.toml", help="The controllers that are kept.")
@option(
    "--seconds",
    "-s",
    type=click.FloatRange(1.0, RECORDING.longest_s),
    default=600.0,
    help="Length of the work, by the board's clock.",
)
@option("--budget", type=click.IntRange(1, 100_000), default=300, help="Evaluations of each search.")
@option("--seed", type=click.IntRange(0, MOST_SEED), default=0, help="Where all random numbers start.")
@option("--store", is_flag=True, help="Store what was kept, without asking.")
@overwrite_option
@port_option
@json_option("greywhale.adapt.result:AdaptAnswer")
def command(
    model: Path,
    out: Path,
    seconds: float,
    budget: int,
    seed: int,
    store: bool,
    overwrite: bool,
    port: str | None,
    as_json: bool,
) -> None:
    """Adapt the controllers while you work with the arm: the motors are on, and the follower follows your hand.

    MODEL is the model.toml of this arm. The program watches, fits the model to what the arm does now, and searches in
    the background on the motions that you make. A set that promises more than its uncertainty runs on trial from the
    next rest of your hand on; it is kept only if a gain can be told from chance, and goes back at once if the arm
    follows worse. Rest for a moment now and then: sets change at no other time.

    Nothing is stored before the end, where a terminal asks; scripts say --store. Ctrl-C, a lost port or a fault stop
    the motors and leave the stored set.
    """
    # The native simulation takes a moment to import.
    from greywhale.adapt import AdaptationRequest, adapt, store_kept
    from greywhale.adapt.result import AdaptAnswer

    refuse_inputs(out, model)
    require_new(overwrite, out)
    request = AdaptationRequest(choose_port(port), model, out, LocalWorkers(1), seconds, budget, seed)

    with progress() as report:
        outcome = adapt(request, report, warn_page)
    if outcome.improved and (store or (not as_json and _agrees(outcome))):
        outcome = store_kept(request.port, outcome)
    answer: AdaptAnswer = {"port": request.port, **outcome.as_dict(), "out": str(out) if outcome.improved else None}
    upload = Step("upload", "Store the controllers that were kept", {"controller": str(out)})
    show(as_json, answer, Telling(outcome.tell(), [upload] if outcome.improved and not outcome.stored else []))


def _agrees(outcome: AdaptationResult) -> bool:
    """Ask on the terminal whether to store; nobody agrees where there is none."""
    if not (sys.stdin.isatty() and sys.stderr.isatty()):
        return False
    tell(outcome.text())
    return click.confirm("Store the controllers that were kept?", err=True)
