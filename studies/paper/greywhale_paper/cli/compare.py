"""`greywhale compare`: optimisers side by side at equal budgets."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import click

from greywhale.base.errors import BadUsage
from greywhale.base.study import choose_workers
from greywhale.cli.output import FILE, json_option, option, overwrite_option, progress, show, workers_options
from greywhale.files.outputs import require_new
from greywhale.optimise import METHODS
from greywhale_paper.optimisers.comparison import PEERS, Plan, compare
from greywhale_paper.optimisers.comparison_report import ComparisonFacts, as_dict, check_format, text, write_report
from greywhale_paper.optimisers.functions import FUNCTIONS, Setting

# With fewer evaluations in all, starting other processes takes longer than they save.
SMALL = 300_000


class CompareAnswer(ComparisonFacts):
    files: list[str]


@click.command("compare")
@option("--functions", metavar="NAME,...", help=f"Which functions; without it all: {', '.join(FUNCTIONS)}.")
@option(
    "--methods",
    metavar="NAME,...",
    help=f"Which methods; without it {', '.join(METHODS)}. With greywhale-paper[peers] also {', '.join(PEERS)}.",
)
@option(
    "--settings",
    metavar="NAME,...",
    default="plain,shifted",
    help="Where the minimum lies: plain (as published), shifted (away from the origin), rotated (shifted and turned).",
)
@option("--dimensions", type=int, default=10, help="Coordinates of every function.")
@option("--budget", type=int, default=500, help="Evaluations of every run.")
@option("--seeds", "runs", type=int, default=25, help="Runs of every method on every function.")
@option("--pack", type=int, help="Pack of every method; without it, each method's own.")
@option("--seed", type=int, default=0, help="Where all random numbers start.")
@workers_options("--jobs")
@option("--results", type=FILE, help="Keep here what is done; the same command goes on from it after Ctrl-C or a kill.")
@option(
    "--out",
    "-o",
    type=FILE,
    multiple=True,
    help="Write all runs (.csv) or a picture of the ranks (.png, .svg, .pdf); may be given more than once.",
)
@overwrite_option
@json_option(CompareAnswer)
def command(
    functions: str | None,
    methods: str | None,
    settings: str,
    workers: int | None,
    scheduler: str | None,
    results: Path | None,
    out: tuple[Path, ...],
    overwrite: bool,
    as_json: bool,
    **sizes: Any,
) -> None:
    """Compare optimisers on standard functions, plain and shifted, at equal budgets.

    Grey wolf and whale optimisers favour the origin of the coordinates, where most standard functions have their
    minimum. The same functions shifted show what they are worth elsewhere. The result depends on --seed alone, not on
    where and in how many processes it is computed.
    """
    for path in out:
        check_format(path)
        require_new(overwrite, path)
        if results is not None and path.absolute() == results.absolute():
            raise BadUsage(f"{path}: this is the results file; write the report elsewhere.")
    plan = Plan(
        functions=_names(functions, tuple(FUNCTIONS)),
        settings=cast(tuple[Setting, ...], _names(settings, ())),
        methods=_names(methods, tuple(METHODS)),
        **sizes,
    )
    plan.check()
    if workers is None and scheduler is None and plan.evaluations < SMALL:
        workers = 1
    with progress() as report:
        comparison = compare(plan, choose_workers(workers, scheduler), report, results)
    for path in out:
        write_report(path, comparison)
    written = "".join(f"\nWritten: {path}" for path in out)
    answer: CompareAnswer = {**as_dict(comparison), "files": [str(path) for path in out]}
    show(as_json, answer, text(comparison) + written)


def _names(chosen: str | None, default: tuple[str, ...]) -> tuple[str, ...]:
    if chosen is None:
        return default
    return tuple(name.strip() for name in chosen.split(",") if name.strip())
