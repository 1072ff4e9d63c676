"""`greywhale commission`: controllers that are proven on the connected arm itself."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from greywhale.base.errors import MOST_SEED, MOST_WORKERS, BadUsage
from greywhale.base.telling import Sentences, Step, Telling
from greywhale.board.session import Session
from greywhale.cli import completion
from greywhale.cli.countdown import prepare_motion, yes_option
from greywhale.cli.output import FILE, json_option, option, port_option, progress, show
from greywhale.files.outputs import require_folder
from greywhale.protocol.ports import choose_port


@click.command("commission")
@option("--out", "-o", type=FILE, default="commission", help="Folder for all files.")
@option(
    "--arm",
    "arm_file",
    shell_complete=completion.arms,
    help="Your arm.toml: geometry, nominal motors.  [default: the model's arm, or white_box]",
)
@option("--model", type=FILE, help="A model.toml of this arm to begin with, instead of identifying first.")
@option(
    "--range",
    "ranges",
    multiple=True,
    metavar="J:MIN:MAX",
    help="Range of a joint in rad, instead of 1 rad to either side of where it is.",
)
@option("--rounds", type=click.IntRange(1, 20), default=2, help="Models to make at most.")
@option("--trials", type=click.IntRange(1, 100), default=8, help="Sets to try on the arm in each round.")
@option("--budget", type=click.IntRange(1, 1_000_000), help="Evaluations of `tune`; without it, as many as it tries.")
@option("--seed", type=click.IntRange(0, MOST_SEED), default=0, help="Where all random numbers start.")
@option("--workers", type=click.IntRange(1, MOST_WORKERS), help="Threads; without it, one for every processor.")
@option("--resume", is_flag=True, help="Go on where an interrupted commissioning in this folder ended.")
@yes_option
@port_option
@json_option("greywhale.commission.result:CommissionAnswer")
def command(
    out: Path,
    ranges: tuple[str, ...],
    workers: int | None,
    yes: bool,
    port: str | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Find controllers for the connected arm, and prove them on it.

    The arm moves by itself for some minutes, within its limits, 1 rad to either side of where it is: clear its
    surroundings, or narrow the joints' --range, and keep a hand on the switch of the motors' supply. It is identified,
    tuned for, and led along motions that nobody trained on, with one set of controllers after another, small moves
    first. A joint that hunts is stopped at once.

    The board ends with the best that was measured, joint by joint, never worse than before; until then it keeps the
    controllers from before. A countdown on the terminal comes first, but not on the simulated bench. Ctrl-C stops the
    motors at any point; --resume goes on. FOLDER/report.html tells the story.
    """
    # Scipy and the native simulation take a moment to import.
    from greywhale.commission import CommissioningRequest, commission
    from greywhale.commission.page import save_page
    from greywhale.commission.result import CommissionAnswer
    from greywhale.identify.excite import parse_range

    chosen = dict(parse_range(text) for text in ranges)
    if len(chosen) < len(ranges):
        raise BadUsage("--range names a joint twice; give each joint once.")
    require_folder(out, "logs, models and controllers", "report.html")
    request = CommissioningRequest(choose_port(port), out, ranges=chosen, threads=workers or 0, **options)
    warn = prepare_motion(request.port, yes)
    # Also while it computes: whoever stops it does not expect the arm to move again.
    with Session.of(request.port):
        warn()
        with progress() as report:
            outcome = commission(request, report)
    page = save_page(outcome, out / "report.html")
    answer: CommissionAnswer = {"port": request.port, **outcome.as_dict(), "report": str(page)}
    made = out / f"model-{len(outcome.rounds)}.toml"
    given = {"model": str(made if made.exists() else options["model"])}  # one that it began with may be the only one
    steps = [Step("adapt", "Keep the controllers right while you work", given)] if outcome.improved else []
    show(as_json, answer, Telling([*outcome.tell(), Sentences([f"Written: {page}"])], steps))
