"""The workers that the options --executor and --workers of a verb name."""

from __future__ import annotations

import re

from greywhale.base.errors import BAD_USAGE, MOST_WORKERS, UserError, require_within
from greywhale.base.study.cluster import DaskWorkers
from greywhale.base.study.local import LocalWorkers, SerialWorkers
from greywhale.base.study.workers import Workers

FORMS = "local, dask://HOST:PORT (of this machine) or tls://HOST:PORT"


def choose_workers(executor: str = "local", count: int | None = None) -> Workers:
    """`local`: so many processes here (1: this one; None: one for every processor); or a Dask scheduler,
    `dask://HOST:PORT` on this machine, `tls://HOST:PORT` anywhere. UserError where the text is none of these.
    """
    if count is not None:
        require_within("workers", count, 1, MOST_WORKERS)
    if executor == "local":
        return SerialWorkers() if count == 1 else LocalWorkers(count)
    if match := re.fullmatch(r"(dask|tls)://([^/\s:]+|\[[0-9a-fA-F:]+\]):(\d{1,5})/?", executor):
        if count is not None:
            raise UserError("--workers is for local; a Dask scheduler has its own.", BAD_USAGE)
        return DaskWorkers(f"{match[2]}:{match[3]}", tls=match[1] == "tls")
    raise UserError(f"there is no executor {executor!r}; it is {FORMS}.", BAD_USAGE)
