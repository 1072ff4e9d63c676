"""`greywhale reproduce`: the paper from end to end, every table and figure beside what is printed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, TypedDict

import click

from greywhale.cli.output import FILE, json_option, option, progress, show, workers_options
from greywhale.files.outputs import require_folder
from greywhale_paper.request import Request

STATUSES = ("computed anew", "measured anew on the bench", "drawn from the text", "cannot be reproduced")


class ReproduceAnswer(TypedDict):
    request: Request
    files: list[str]  # HTML, PDF, JSON
    entries: dict[str, Annotated[str, ("enum", [*STATUSES])]]  # what became of each table and figure, by its label


@click.command("reproduce")
@option("--out", "-o", type=FILE, default="reproduce", help="Folder for the report and the results of its parts.")
@option("--quick", is_flag=True, help="Fewer seeds, shorter logs, smaller budgets: a look at everything.")
@option("--seeds", type=int, help="Runs of everything random; without it 10, with --quick 4.")
@option("--seed", type=int, default=0, help="The first of them.")
@workers_options()
@json_option(ReproduceAnswer)
def command(
    out: Path, quick: bool, seeds: int | None, seed: int, workers: int | None, scheduler: str | None, as_json: bool
) -> None:
    """Reproduce the paper: every table and figure with our numbers beside the printed ones.

    Writes report.html, which needs no other file, report.pdf and report.json into the folder. The experiment is the
    compiled firmware on the simulated bench, seen through its logs alone; tables and figures that need the authors' own
    arm are named. The numbers depend on --seed, --seeds and --quick alone. What was done before Ctrl-C is kept: the
    same command goes on from there.
    """
    require_folder(out, "report and results", "report.html", "report.pdf", "report.json")
    from greywhale.base.formats.whole import write_text
    from greywhale.base.study import choose_workers
    from greywhale_paper.pages.found import Found
    from greywhale_paper.run import run

    request = Request.of(seed, seeds, quick)
    with progress() as report:
        results = run(request, out, choose_workers(workers, scheduler), report)
        # Slow to import, and of no use before all is done.
        from greywhale_paper.pages.report import document
        from greywhale_paper.render.html import write_html
        from greywhale_paper.render.pdf import write_pdf

        made = document(Found(request, results))
        files = [write_html(made, out / "report.html"), write_pdf(made, out / "report.pdf")]
        facts = {"request": request.as_dict(), **made.as_dict()}
        write_text(out / "report.json", json.dumps(facts, indent=1, ensure_ascii=False) + "\n")
    files.append(out / "report.json")
    statuses = {entry.label: entry.status.value for entry in made.entries if entry.label}
    answer: ReproduceAnswer = {"request": request, "files": [str(path) for path in files], "entries": statuses}
    show(as_json, answer, "\n".join([*made.about, f"Written: {', '.join(answer['files'])}"]))
