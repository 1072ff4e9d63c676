"""`greywhale identify`: logs to a model of the arm that made them."""

from __future__ import annotations

from pathlib import Path

import click

from greywhale.base.errors import MOST_SEED
from greywhale.base.formats.whole import refuse_inputs
from greywhale.base.telling import Sentences, Step, Telling
from greywhale.cli import completion
from greywhale.cli.output import FILE, json_option, option, overwrite_option, progress, show
from greywhale.files.arm import load_arm
from greywhale.files.log import Log, read_log
from greywhale.files.log.limits import SELECTION
from greywhale.files.log.selection import informative
from greywhale.files.outputs import require_folder, require_new, require_no_files
from greywhale.files.parameter_file import load_table
from greywhale.identify import METHODS, identify
from greywhale.identify.result import IdentificationResult, ResultFacts


class IdentifyAnswer(ResultFacts):
    files: list[str]  # that were written
    notes: list[str]  # logs of which a part was used


@click.command("identify")
@click.argument("logs", metavar="LOG...", nargs=-1, required=True, type=FILE)
@option(
    "--validate",
    "-v",
    type=FILE,
    multiple=True,
    help="A log that only judges the model; best are one of the same and one of another controller.",
)
@option(
    "--arm",
    "arm_file",
    default="white_box",
    shell_complete=completion.arms,
    help="Your arm.toml: geometry, nominal motors.",
)
@option("--out", "-o", type=FILE, default="model.toml")
@option(
    "--controller",
    "-c",
    "controllers",
    type=FILE,
    shell_complete=completion.controllers,
    multiple=True,
    help="A controller.toml or `params backup` file that logs were recorded with; logs find theirs by its CRC.",
)
@option("--method", type=click.Choice(METHODS), default="default")
@option("--seed", type=click.IntRange(0, MOST_SEED), default=0, help="Where all random numbers start.")
@option("--pictures", type=FILE, help="Folder for pictures of responses and convergence.")
@overwrite_option
@json_option(IdentifyAnswer)
def command(
    logs: tuple[Path, ...],
    validate: tuple[Path, ...],
    arm_file: str,
    out: Path,
    controllers: tuple[Path, ...],
    method: str,
    seed: int,
    pictures: Path | None,
    overwrite: bool,
    as_json: bool,
) -> None:
    """Identify the arm that made the logs, starting from your arm file.

    Of a log longer than 60 s the pieces that show most are used. Writes a model.toml: an arm file with a table on how
    sure each value is, what these logs cannot tell and which motion would. Ctrl-C writes the best model so far, marked
    as unfinished.
    """
    refuse_inputs(out, *logs, *validate, arm_file, *controllers)
    require_new(overwrite, out)
    require_folder(pictures, "pictures")
    require_no_files(overwrite, pictures, "convergence.png", "responses_*.png")
    arm = load_arm(arm_file)
    tables = [load_table(path) for path in controllers]
    notes: list[str] = []
    fit, second = [_read(path, notes) for path in logs], [_read(path, notes) for path in validate]
    with progress() as report:
        outcome = identify(fit, arm, validate=second, tables=tables, method=method, seed=seed, report=report)
    outcome.save(out)
    if not outcome.complete:
        interrupted = KeyboardInterrupt()
        interrupted.add_note(f"The best model so far is in {out}, marked as unfinished.")
        raise interrupted
    files = [out]
    if pictures is not None:
        # Matplotlib takes a second to import.
        from greywhale.identify.pictures import draw

        files += draw(outcome, pictures)
    answer: IdentifyAnswer = {**outcome.as_dict(), "files": [str(path) for path in files], "notes": notes}
    written = Sentences(["Written: " + ", ".join(map(str, files))])
    show(as_json, answer, Telling([Sentences(notes), *outcome.tell(), written], _next(out, outcome)))


def _next(out: Path, outcome: IdentificationResult) -> list[Step]:
    """Tune on the model; where that has doubts, show the arm what it left open first."""
    tune = Step("tune", "Tune the controllers on this model", {"model_file": str(out)})
    more = {"excite": True, "arm_file": str(out), "out": "more.csv"}
    record = Step("record", "Record a motion that shows what is left open", more)
    return [record] if outcome.doubts else [tune, record] if outcome.found.open else [tune]


def _read(path: Path, notes: list[str]) -> Log:
    """The part of a log that is used; a note says so where that is not all of it."""
    whole = read_log(path)
    used = informative(whole)
    if used is not whole:
        length = whole.time[-1] - whole.time[0]
        used_s = SELECTION.most_used_s
        notes.append(f"{path}: of {length:.0f} s the {used_s:g} s that show most about the arm are used.")
    return used
