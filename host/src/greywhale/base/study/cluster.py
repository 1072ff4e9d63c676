"""The workers of a Dask scheduler, on other machines or here. Dask is an extra: `pip install 'greywhale[cluster]'`."""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import ipaddress
import logging
import pickle
import ssl
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Executor, Future
from functools import partial
from typing import Any, ParamSpec, TypeVar
from urllib.parse import urlsplit

from greywhale.base.errors import BadUsage, UserError, os_reason

P = ParamSpec("P")
T = TypeVar("T")

# So long a scheduler may take to answer, and then its first worker to come: an answer takes milliseconds, and a person
# waits.
ANSWER_S = 5.0
WORKER_S = 5.0


class ClusterWorkers:
    """Those of the Dask scheduler at an address such as tls://10.0.0.5:8786, with the certificates that Dask's own
    configuration names. tcp://, which asks nobody who they are, reaches this machine alone.

    Dask gives the tasks of a lost worker to the others. UserError: what an address is, or who does not answer there.
    """

    at_once = None

    def __init__(self, address: str) -> None:
        self.address = address
        scheme = _scheme(address)
        try:
            self._distributed: Any = importlib.import_module("distributed")  # it takes a second
        except ImportError:
            raise BadUsage("a scheduler needs Dask; install it: pip install 'greywhale[cluster]'.") from None
        self._security = _security(self._distributed) if scheme == "tls" else None

    @contextlib.contextmanager
    def executor(self) -> Iterator[Executor]:
        with _quiet(), self._client() as client:  # leaving it cancels what it asked for
            try:
                client.wait_for_workers(1, timeout=WORKER_S)
            except TimeoutError:
                raise UserError(
                    f"the Dask scheduler at {self.address} has no worker; start some: dask worker {self.address} "
                    "--nthreads 1."
                ) from None
            yield _Executor(client, self._distributed)

    def _client(self) -> Any:
        options = {"timeout": ANSWER_S, "set_as_default": False, "security": self._security}
        try:
            return self._distributed.Client(self.address, **options)
        except (OSError, ValueError):
            certificates = " with certificates of the same authority" if self._security else ""
            raise UserError(
                f"no Dask scheduler answers at {self.address}; start one there{certificates}, or give the address that "
                "a running one prints."
            ) from None


class _Executor(Executor):
    """Not Dask's own (`Client.get_executor`), which takes a result for an error if its worker is lost just then."""

    def __init__(self, client: Any, distributed: Any) -> None:
        self._client = client
        self._distributed = distributed

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        future: Future[T] = Future()
        # The worker loads the call itself: one without greywhale says so then, but ends if Dask loads it.
        # Not pure: the same task of another study is another task, with an error of its own.
        task = self._client.submit(pickle.loads, pickle.dumps(_Call(partial(fn, *args, **kwargs))), pure=False)
        self._client.loop.add_callback(self._pass_on, task, future)
        return future

    async def _pass_on(self, task: Any, future: Future[Any]) -> None:
        """Runs in Dask's thread. A client that closes may leave it waiting, and nobody waits for it."""
        try:
            result = await self._client.gather(task, asynchronous=True)
        except (CancelledError, asyncio.CancelledError, self._distributed.comm.CommClosedError):
            future.cancel()
            future.set_running_or_notify_cancel()
        except self._distributed.KilledWorker:
            _end(
                future, UserError("one worker after the other ended with the task in its hands; give them more memory.")
            )
        except ImportError as error:
            _end(future, UserError(f"a worker cannot import what the study does: {error}; install the same there."))
        except Exception as error:
            _end(future, error)
        else:
            if future.set_running_or_notify_cancel():
                future.set_result(result)


class _Call:
    """Its pickle is what the call returns where it is loaded."""

    def __init__(self, call: Callable[[], Any]) -> None:
        self._call = call

    def __reduce__(self) -> tuple[Callable[[], Any], tuple[()]]:
        return self._call, ()


def _end(future: Future[Any], error: Exception) -> None:
    if future.set_running_or_notify_cancel():
        future.set_exception(error)


def _scheme(address: str) -> str:
    """tls or tcp. Without TLS whoever answers, or sits between, could run programs here: only this machine may."""
    with contextlib.suppress(ValueError):
        parts = urlsplit(address)
        bare = f"{parts.scheme}://{parts.netloc}"
        if parts.scheme in ("tls", "tcp") and parts.hostname and parts.port and bare == address and "@" not in address:
            if parts.scheme == "tls" or _is_loopback(parts.hostname):
                return parts.scheme
            raise BadUsage(
                f"{address} is not on this machine, and tcp:// would not tell who answers there; take "
                f"tls://{parts.netloc} with certificates (docs/study.md)."
            )
    raise BadUsage(f"{address!r} is no address of a scheduler; give tls://HOST:PORT, or tcp://127.0.0.1:PORT.")


def _is_loopback(host: str) -> bool:
    with contextlib.suppress(ValueError):
        return ipaddress.ip_address(host).is_loopback
    return host == "localhost"


def _security(distributed: Any) -> Any:
    """The certificates that Dask's configuration names, which can be read."""
    security = distributed.Security(require_encryption=True)
    files = [one for one in (security.tls_ca_file, security.tls_client_cert, security.tls_client_key) if one]
    if not (security.tls_ca_file and security.tls_client_cert):
        raise BadUsage(
            "tls:// needs certificates; name ca-file and client: cert in ~/.config/dask/distributed.yaml, under "
            "distributed: comm: tls (docs/study.md)."
        )
    try:
        security.get_connection_args("client")
    except OSError as error:
        reason = "they are no PEM certificate and its key" if isinstance(error, ssl.SSLError) else os_reason(error)
        named = ", ".join(dict.fromkeys(files))
        raise UserError(f"the certificates of Dask's configuration ({named}) cannot be used: {reason}.") from None
    return security


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Silence Dask's log of lost workers and closed connections, which are no news to a study."""
    logger = logging.getLogger("distributed")
    before = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(before)
