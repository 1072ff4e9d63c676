"""Workers of a Dask scheduler, here or on other machines. They need an extra of the package."""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import ipaddress
import logging
import ssl
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from importlib.metadata import PackageNotFoundError, version
from queue import SimpleQueue
from threading import Thread
from types import ModuleType
from typing import Any, ParamSpec, TypeVar

from greywhale.base.errors import BAD_USAGE, UserError, os_reason
from greywhale.base.study.task import versions

P = ParamSpec("P")
T = TypeVar("T")


class DaskWorkers:
    """Those of the Dask scheduler at HOST:PORT, who have the same versions of greywhale, numpy and scipy.

    A scheduler beyond this machine is reached by TLS alone, with the certificates that Dask's configuration names.
    Dask itself gives a lost worker's tasks to the others. It gives up a task after several workers
    (`distributed.scheduler.allowed-failures`), and then it may have had bad neighbours: the study tries it alone.
    """

    at_once = None

    def __init__(self, address: str, wait_s: float = 10.0, tls: bool = False) -> None:
        if not tls:
            _require_loopback(address)
        self.address = address
        self._url = f"{'tls' if tls else 'tcp'}://{address}"
        self._wait_s = wait_s  # for the scheduler's answer
        self._distributed = _package("distributed")
        self._security = _security(self._distributed) if tls else None

    @contextlib.contextmanager
    def executor(self) -> Iterator[Executor]:
        with _quiet(), self._client() as client:
            self._require_same_versions(client)
            executor = _Executor(client, self._distributed.comm.CommClosedError)
            try:
                yield executor
            finally:
                executor.shutdown()

    def deaths(self, error: BaseException) -> int:
        if isinstance(error, self._distributed.KilledWorker):
            return 2
        return 1 if isinstance(error, BrokenExecutor) else 0

    def _client(self) -> Any:
        try:
            return self._distributed.Client(
                self._url, timeout=self._wait_s, set_as_default=False, security=self._security
            )
        except (OSError, ValueError):
            raise UserError(
                f"{self._url}: no Dask scheduler answers there; start one with `dask scheduler` and workers with "
                "`dask worker`, or give the address that a running one prints. With TLS both sides need certificates "
                "of the same authority."
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
        self._ended: SimpleQueue[tuple[Any, Future[Any]] | None] = SimpleQueue()
        # A client that closes may never answer who asks it for a result. Python would wait for Dask's own thread of
        # callbacks when it ends; it does not wait for this one.
        Thread(target=self._pass_on, name="results of Dask", daemon=True).start()

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        future: Future[T] = Future()
        # Not pure: a task that is tried again must not be answered with its last error.
        task = self._client.submit(fn, *args, **kwargs, pure=False)
        task.add_done_callback(lambda task: self._ended.put((task, future)))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Take no more results."""
        self._ended.put(None)

    def _pass_on(self) -> None:
        while (ended := self._ended.get()) is not None:
            task, future = ended
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


def _require_loopback(address: str) -> None:
    """Without TLS whoever answers, or sits between, could run programs as this user: only this machine may answer."""
    host = address.rpartition(":")[0].strip("[]")
    with contextlib.suppress(ValueError):
        if host == "localhost" or ipaddress.ip_address(host).is_loopback:
            return
    raise UserError(
        f"dask://{address} is not on this machine, and nothing would tell who answers there; take tls://{address} with "
        "certificates, or an SSH tunnel and dask://127.0.0.1:PORT (docs/study.md shows both).",
        BAD_USAGE,
    )


def _security(distributed: ModuleType) -> Any:
    """The certificates that Dask's own configuration names, which can be read."""
    security = distributed.Security(require_encryption=True)
    if not (security.tls_ca_file and security.tls_client_cert):
        raise UserError(
            "tls:// needs certificates; name ca-file and client: cert in ~/.config/dask, under distributed: comm: tls.",
            BAD_USAGE,
        )
    try:
        security.get_connection_args("client")
    except OSError as error:
        files = [one for one in (security.tls_ca_file, security.tls_client_cert, security.tls_client_key) if one]
        named = ", ".join(dict.fromkeys(files))
        reason = "they are no PEM certificate and its key" if isinstance(error, ssl.SSLError) else os_reason(error)
        raise UserError(f"the certificates of Dask's configuration ({named}) cannot be used: {reason}.") from None
    return security


def _package(name: str) -> ModuleType:
    """Dask's package, which not everybody has; it takes a second to import."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError:
        raise UserError(f"{name} is not installed; pip install 'greywhale[dask]'.", BAD_USAGE) from None


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
