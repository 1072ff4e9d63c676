"""Does the pieces of work of a request as a study: on any workers, and on from where it was ended."""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Any

import greywhale
from greywhale.base.formats.whole import make_folder
from greywhale.base.study import Workers, run_study
from greywhale.base.types import NotedProgress, show_no_progress
from greywhale_paper.request import Request
from greywhale_paper.tasks import tasks_of

Results = dict[str, dict[str, Any]]
PACKAGES = (Path(greywhale.__file__).resolve().parent, Path(__file__).resolve().parent)
# What only shows: a change of it makes no result old.
SHOWING = {"cli", "pages", "pictures", "render"}


def run(request: Request, folder: Path, workers: Workers, report: NotedProgress = show_no_progress) -> Results:
    """Everything that a request asks for, by the tasks' keys. An interrupt keeps what is done in `folder`."""
    make_folder(folder)
    about = {"request": request.as_dict(), "program": program_digest()}
    tasks = tasks_of(request)

    def tell(what: str, share: float) -> None:
        report(what, share, f"{round(share * len(tasks))} of {len(tasks)} parts")

    return run_study(tasks, workers, results_file(request, folder), tell, about=about, what="reproducing the paper")


def results_file(request: Request, folder: Path) -> Path:
    """Where the results of a request to this very program are kept; another request has another file."""
    asked = json.dumps([request.as_dict(), program_digest()])
    return folder / f"results-{hashlib.sha256(asked.encode()).hexdigest()[:12]}.study"


@cache
def program_digest() -> str:
    """SHA-256 of both packages' files, what only shows apart: results of another program are not taken."""
    digest = hashlib.sha256()
    for package in PACKAGES:
        for path in sorted(package.rglob("*")):
            name = path.relative_to(package)
            if path.suffix in (".py", ".toml", ".so") and not SHOWING & set(name.parts) and path.is_file():
                digest.update(str(name).encode())
                digest.update(path.read_bytes())
    return digest.hexdigest()
