"""Workers on other machines: a Dask scheduler's, or jobs of a Slurm partition. Both need an extra of the package."""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import logging
import shutil
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from importlib.metadata import PackageNotFoundError, version
from types import ModuleType
from typing import Any, ParamSpec, TypeVar

from greywhale.errors import BAD_USAGE, UserError
from greywhale.study.task import versions

P = ParamSpec("P")
T = TypeVar("T")
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
            self._require_same_versions(client)
            yield _Executor(client, self._distributed.comm.CommClosedError)

    def deaths(self, error: BaseException) -> int:
        if isinstance(error, self._distributed.KilledWorker):
            return 2
        return 1 if isinstance(error, BrokenExecutor) else 0

    def _client(self) -> Any:
        try:
            return self._distributed.Client(f"tcp://{self.address}", timeout=self._wait_s, set_as_default=False)
        except (OSError, ValueError):
            raise UserError(
                f"{self.address}: no Dask scheduler answers there; start one with `dask scheduler` and workers with "
                "`dask worker HOST:PORT`, or give the address that a running one prints."
            ) from None

    def _require_same_versions(self, client: Any) -> None:
        """Every task asks for them too, but a worker without greywhale ends when it gets one, and says nothing."""
        for package, wanted in versions().items():
            for worker, found in client.run(version, package, on_error="return").items():
                if isinstance(found, PackageNotFoundError):
                    raise UserError(f"the worker {worker} has no {package}; install {package} {wanted} there.")
                if isinstance(found, str) and found != wanted:
                    raise UserError(
                        f"the worker {worker} has {package} {found}, but this study needs {wanted}; install the same "
                        "there."
                    )


class _Executor(Executor):
    """`Client.get_executor()` may mistake a result for an error if its worker is lost at that moment: it asks for the
    result and then for the state. Here the client alone decides, which asks again until the result is there.
    """

    def __init__(self, client: Any, closed: type[Exception]) -> None:
        self._client = client
        self._closed = closed

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        future: Future[T] = Future()

        def pass_on(task: Any) -> None:
            """In a thread of the client's."""
            try:
                result = task.result()
            except (CancelledError, asyncio.CancelledError, self._closed):  # the scheduler is lost
                future.cancel()
                future.set_running_or_notify_cancel()
            except Exception as error:
                if future.set_running_or_notify_cancel():
                    future.set_exception(error)
            else:
                if future.set_running_or_notify_cancel():
                    future.set_result(result)

        # Not pure: a task that is tried again must not be answered with its last error.
        self._client.submit(fn, *args, **kwargs, pure=False).add_done_callback(pass_on)
        return future


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
        if shutil.which("sbatch") is None:
            raise UserError("sbatch was not found; begin the study on a machine that submits jobs to Slurm.")
        with _quiet(), self.cluster() as cluster:
            cluster.scale(jobs=self.jobs)
            with self._distributed.Client(cluster, set_as_default=False) as client:
                yield _Executor(client, self._distributed.comm.CommClosedError)

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
        # Several studies may run here, so any free port will do for the dashboard.
        return self._jobqueue.SLURMCluster(**chosen, scheduler_options={"dashboard_address": ":0"})


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
