"""The workers that the options --executor and --workers of a verb name."""

from __future__ import annotations

import re

from greywhale.errors import BAD_USAGE, MOST_WORKERS, UserError, require_within
from greywhale.study.cluster import DaskWorkers, SlurmWorkers
from greywhale.study.local import LocalWorkers, SerialWorkers
from greywhale.study.workers import Workers

FORMS = "local, dask://HOST:PORT or slurm://[PARTITION]"


def choose_workers(executor: str = "local", count: int | None = None) -> Workers:
    """`local`: so many processes here (1: this one; None: one for every processor); `dask://HOST:PORT`; or
    `slurm://[PARTITION]` with so many jobs. UserError where the text is none of these.
    """
    if count is not None:
        require_within("workers", count, 1, MOST_WORKERS)
    if executor == "local":
        return SerialWorkers() if count == 1 else LocalWorkers(count)
    if match := re.fullmatch(r"dask://([^/\s:]+|\[[0-9a-fA-F:]+\]):(\d{1,5})/?", executor):
        if count is not None:
            raise UserError("--workers is for local and slurm://; a Dask scheduler has its own.", BAD_USAGE)
        return DaskWorkers(f"{match[1]}:{match[2]}")
    if match := re.fullmatch(r"slurm://([\w.,+-]*)/?", executor):
        return SlurmWorkers(match[1] or None, count or 1)
    raise UserError(f"there is no executor {executor!r}; it is {FORMS}.", BAD_USAGE)
