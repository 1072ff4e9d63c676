"""The whole report: the chapters in the paper's order, from one request's results."""

from __future__ import annotations

from collections import Counter

from greywhale_paper.pages import claims, experiment, findings, identification, law, optimisers, system, tuning
from greywhale_paper.pages.document import Document, Status
from greywhale_paper.pages.found import Found
from greywhale_paper.pages.printed import TITLE


def document(found: Found) -> Document:
    request = found.request
    chapters = (
        claims.chapter(found),
        system.chapter(),
        identification.chapter(found),
        law.chapter(),
        tuning.chapter(found),
        experiment.chapter(found),
        optimisers.chapter(found),
        findings.chapter(found),
    )
    counts = Counter(entry.status for chapter in chapters for entry in chapter.entries if entry.label)
    told = ", ".join(f"{counts[status]} {status.value}" for status in Status if counts[status])
    size = (
        "A quick look: shorter logs, fewer seeds, a smaller budget of greywhale's own tuning. " if request.quick else ""
    )
    return Document(
        "The paper, computed anew",
        (
            f"{TITLE}.",
            f"Of its 12 tables and 20 figures: {told}. Shaded columns are printed in the paper; every other number is "
            "computed by this run, except the cycles of the output sets on page 1.",
            f"{size}The paper's methods and the optimisers ran with {_name(request.every_seed)}, greywhale's own "
            f"tuning with {_name(request.few_seeds)}. The experiment is the compiled firmware on the simulated "
            "board, with the default arm and with one like the paper's, seen through its logs only; it runs in "
            "lock step, so the same seeds give the same numbers.",
        ),
        chapters,
    )


def _name(seeds: tuple[int, ...]) -> str:
    return f"seeds {seeds[0]} to {seeds[-1]}" if len(seeds) > 1 else f"seed {seeds[0]}"
