"""Workers on other machines: a Dask scheduler's, or jobs of a Slurm partition. Both need an extra of the package."""

from __future__ import annotations

import contextlib
import importlib
import logging
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor
from types import ModuleType
from typing import Any

from greywhale.errors import BAD_USAGE, UserError

# What a job gets where the user's own jobqueue.yaml does not say.
JOB: dict[str, Any] = {"cores": 1, "processes": 1, "memory": "2GB"}


class DaskWorkers:
    """Those of the Dask scheduler at HOST:PORT, who have the same versions of greywhale, numpy and scipy.

    Dask itself gives a lost worker's tasks to the others. It gives up a task after several workers
    (`distributed.scheduler.allowed-failures`), and then it may have had bad neighbours: the study tries it alone.
    """

    at_once = None

    def __init__(self, address: str, wait_s: float = 10.0) -> None:
        self.address = address
        self._wait_s = wait_s  # for the scheduler's answer
        self._distributed = _package("distributed", "dask")

    @contextlib.contextmanager
    def executor(self) -> Iterator[Executor]:
        with _quiet(), self._client() as client:
            # Not pure: a task that is tried again must not be answered with its last error.
            yield client.get_executor(pure=False)

    def deaths(self, error: BaseException) -> int:
        if isinstance(error, self._distributed.KilledWorker):
            return 2
        return 1 if isinstance(error, BrokenExecutor) else 0

    def _client(self) -> Any:
        try:
            return self._distributed.Client(f"tcp://{self.address}", timeout=self._wait_s, set_as_default=False)
        except (OSError, ValueError):
            raise UserError(f"{self.address}: no Dask scheduler answers there.") from None


class SlurmWorkers:
    """Jobs that greywhale submits to a Slurm partition (None: the cluster's own choice) and ends with the study.

    The user's ~/.config/dask/jobqueue.yaml says what else a job needs (account, walltime, memory).
    """

    at_once = None

    def __init__(self, partition: str | None = None, jobs: int = 1) -> None:
        self.partition = partition
        self.jobs = jobs
        self._distributed = _package("distributed", "slurm")
        self._jobqueue = _package("dask_jobqueue", "slurm")

    @contextlib.contextmanager
    def executor(self) -> Iterator[Executor]:
        with _quiet(), self.cluster() as cluster:
            cluster.scale(jobs=self.jobs)
            with self._distributed.Client(cluster, set_as_default=False) as client:
                yield client.get_executor(pure=False)

    def deaths(self, error: BaseException) -> int:
        if isinstance(error, self._distributed.KilledWorker):
            return 2
        return 1 if isinstance(error, BrokenExecutor) else 0

    def cluster(self) -> Any:
        """A `dask_jobqueue.SLURMCluster` without jobs yet; its `job_script()` is what Slurm will get."""
        import dask

        chosen = {key: dask.config.get(f"jobqueue.slurm.{key}", None) or value for key, value in JOB.items()}
        if self.partition is not None:
            chosen["queue"] = self.partition
        return self._jobqueue.SLURMCluster(**chosen, scheduler_options={"dashboard": False})


def _package(name: str, extra: str) -> ModuleType:
    """A package that not everybody has; it takes a second to import."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError:
        raise UserError(f"{name} is not installed; pip install 'greywhale[{extra}]'.", BAD_USAGE) from None


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """What Dask logs of lost workers and closed connections is no news to a study."""
    logger = logging.getLogger("distributed")
    before = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(before)
