"""`greywhale tune`: a model to a controller.toml that can be uploaded as it is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, NotRequired, TypedDict

import click

from greywhale.base.errors import MOST_WORKERS, BadUsage, require_within
from greywhale.base.formats.whole import refuse_inputs
from greywhale.base.telling import Sentences, Step, Telling
from greywhale.cli import completion
from greywhale.cli.output import FILE, json_option, option, overwrite_option, progress, show
from greywhale.files import controller as controller_file
from greywhale.files.outputs import require_files, require_folder, require_new, require_no_files
from greywhale.loop import controller_row
from greywhale.tune import METHODS, STRATEGIES, check_request, tune
from greywhale.tune.limits import TUNING_LIMITS
from greywhale.tune.model import SAMPLES, load_model
from greywhale.tune.report.controller_file import save
from greywhale.tune.report.summary import tell
from greywhale.tune.report.tables import TableFacts, tables_of
from greywhale.tune.result import TuningFacts
from greywhale.tune.search.space import NAMES

GIVEN_NAMES = {name.lower(): name for name in NAMES}


class Layouts(TypedDict):
    tables: NotRequired[list[TableFacts]]  # with --tables


class TuneAnswer(TuningFacts, Layouts):
    doubts: list[str]  # about the model, with --force
    files: list[str]  # that were written


@click.command("tune")
@click.argument("model_file", metavar="MODEL")
@option("--out", "-o", type=FILE, default="controller.toml")
@option(
    "--strategy",
    type=click.Choice(STRATEGIES),
    default="both",
    help="What is searched: membership functions, scaling factors, or both.",
)
@option(
    "--method",
    type=click.Choice(METHODS),
    default="default",
    metavar="NAME",
    help=f"default, paper (its objective, bounds and budget), or an optimiser: {', '.join(METHODS[2:])}.",
)
@option("--budget", type=int, help="Evaluations of every joint's controller; without it, the method's own.")
@option("--seed", type=int, default=0, help="Where all random numbers start.")
@option("--workers", type=int, help="Threads; without it, one for every processor.")
@option(
    "--start",
    type=FILE,
    shell_complete=completion.controllers,
    help="A controller.toml to begin with, or before_tuning; without it, what the board of the logs ran.",
)
@option(
    "--bounds",
    multiple=True,
    metavar="NAME=LOW..HIGH",
    help="Narrow what is searched, in the file's units, for all joints: Ku=3..9. May be given more than once.",
)
@option("--arm", shell_complete=completion.arms, help="Your arm.toml, to make sure that the model is of this arm.")
@option("--params", type=FILE, help="The board's table (`params backup`); without it, that of the model's logs.")
@option("--samples", type=int, default=SAMPLES, help="Arms as likely as the model, itself among them.")
@option(
    "--quiet",
    type=click.FloatRange(0.25, 4.0),
    default=1.0,
    help="2 halves the hiss that is allowed at rest, 0.5 doubles it; quieter motors follow less closely.",
)
@option("--resume", is_flag=True, help="Go on where an interrupted tuning with the same options ended.")
@option("--force", is_flag=True, help="Tune even if there are doubts about the model; the result states them.")
@option("--tables", is_flag=True, help="Also print the paper's Tables 8 to 12: ours beside the printed.")
@option("--pictures", type=FILE, help="Folder for pictures of sets, responses and convergence.")
@overwrite_option
@json_option(TuneAnswer)
def command(
    model_file: str,
    out: Path,
    workers: int | None,
    start: Path | None,
    bounds: tuple[str, ...],
    arm: str | None,
    params: Path | None,
    samples: int,
    quiet: float,
    resume: bool,
    force: bool,
    tables: bool,
    pictures: Path | None,
    overwrite: bool,
    as_json: bool,
    **search: Any,
) -> None:
    """Tune the four controllers for a model of greywhale identify.

    Writes a controller.toml for `greywhale upload`: the very numbers that were simulated. Ctrl-C writes the best so
    far, marked as unfinished; --resume goes on and ends with the same file as if nothing had happened. The result
    depends on model, options and --seed alone, not on the number of workers.
    """
    limits = _bounds(bounds)
    if workers is not None:
        require_within("workers", workers, 1, MOST_WORKERS)
    check_request(**search, bounds=limits)
    journal = out.parent / f"{out.name}.journal"
    overwrite = overwrite or resume
    refuse_inputs(out, model_file, arm, params)
    require_new(overwrite, out)
    require_files(journal)
    require_folder(pictures, "pictures", "sets.png")
    require_no_files(overwrite, pictures, "sets.png", "convergence.png", "responses_*.png")
    if resume and not journal.exists():
        raise BadUsage(f"{journal}: no interrupted tuning is there to go on with; leave --resume out.")
    model = load_model(model_file, samples=samples, seed=search["seed"], force=force, params=params, arm=arm)
    first = controller_row(controller_file.load(start)) if start is not None else None
    with progress() as report:
        outcome = tune(
            model,
            **search,
            threads=workers or 0,
            start=first,
            bounds=limits,
            journal=journal,
            resume=resume,
            judging=replace(TUNING_LIMITS, quiet=quiet),
            report=report,
        )
    save(outcome, out)
    if not outcome.complete:
        interrupted = KeyboardInterrupt()
        interrupted.add_note(
            f"The best controllers so far are in {out}, marked as unfinished; the same command with --resume goes on."
        )
        raise interrupted
    journal.unlink(missing_ok=True)
    files = [out]
    if pictures is not None:
        # Matplotlib takes a second to import.
        from greywhale.tune.report.pictures import draw

        files += draw(outcome, pictures)
    layouts = tables_of(outcome, paper=True) if tables else ()
    told = [*tell(outcome), *(part for table in layouts for part in table.tell())]
    told.append(Sentences(["Written: " + ", ".join(map(str, files))]))
    shown: Layouts = {"tables": [table.as_dict() for table in layouts]} if tables else {}
    answer: TuneAnswer = {
        **outcome.as_dict(),
        "doubts": list(model.doubts),
        "files": [str(path) for path in files],
        **shown,
    }
    upload = Step("upload", "Give the board these controllers", {"controller": str(out)})
    prove = Step("commission", "Prove controllers on the arm itself, from this model on", {"model": model_file})
    show(as_json, answer, Telling(told, [upload, prove]))


def _bounds(given: tuple[str, ...]) -> dict[str, tuple[float, float]]:
    """Read `NAME=LOW..HIGH` as numbers. The search checks the names, and what the firmware can store."""
    found: dict[str, tuple[float, float]] = {}
    for one in given:
        given_name, equals, interval = one.partition("=")
        name = GIVEN_NAMES.get(given_name.lower(), given_name)
        low, dots, high = interval.partition("..")
        try:
            limits = float(low), float(high)
        except ValueError:
            dots = ""
        if not equals or not dots:
            raise BadUsage(f"--bounds {one}: bounds look like NAME=LOW..HIGH, Ku=3..9 for one.")
        if name in found:
            raise BadUsage(f"--bounds {one}: {name} has bounds already; give them once.")
        found[name] = limits
    return found
