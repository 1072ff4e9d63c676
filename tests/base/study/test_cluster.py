"""The schedulers that a study would connect to, before it does. With real ones: tests/oracles/test_cluster.py."""

from __future__ import annotations

import sys
from types import ModuleType

import pytest

from greywhale.base.errors import BadUsage
from greywhale.base.study import ClusterWorkers, LocalWorkers, SerialWorkers, choose_workers


@pytest.fixture
def dask(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", ModuleType("distributed"))


@pytest.mark.usefixtures("dask")
@pytest.mark.parametrize(
    ("count", "scheduler", "kind"),
    [
        (1, None, SerialWorkers),
        (2, None, LocalWorkers),
        (None, None, LocalWorkers),
        (None, "tcp://127.0.0.1:8786", ClusterWorkers),
        (None, "tcp://localhost:8786", ClusterWorkers),
        (None, "tcp://[::1]:8786", ClusterWorkers),
    ],
)
def test_the_options_of_a_verb_choose_the_workers(count: int | None, scheduler: str | None, kind: type) -> None:
    assert isinstance(choose_workers(count, scheduler), kind)


@pytest.mark.usefixtures("dask")
@pytest.mark.parametrize(
    "host", ["10.0.0.5", "cluster.example", "[fe80::1]", "0.0.0.0", "127.0.0.1.example", "localhost.example", "[::]"]
)
def test_without_tls_a_scheduler_elsewhere_is_refused(host: str) -> None:
    with pytest.raises(BadUsage) as refused:
        choose_workers(None, f"tcp://{host}:8786")
    assert refused.value.message == (
        f"tcp://{host}:8786 is not on this machine, and tcp:// would not tell who answers there; take "
        f"tls://{host}:8786 with certificates (docs/study.md)."
    )


@pytest.mark.usefixtures("dask")
@pytest.mark.parametrize(
    "address",
    [
        "",
        "10.0.0.5",
        "10.0.0.5:8786",
        "tls://10.0.0.5",
        "tls://:8786",
        "tls://10.0.0.5:0",
        "tls://10.0.0.5:99999",
        "tls://10.0.0.5:8786/path",
        "tls://[10.0.0.5:8786",
        "tcp://127.0.0.1@10.0.0.5:8786",
        "tcp://127.0.0.1\n:8786",
        "ws://127.0.0.1:8786",
        "inproc://127.0.0.1:8786",
    ],
)
def test_what_is_no_address_is_refused(address: str) -> None:
    with pytest.raises(
        BadUsage, match=r" is no address of a scheduler; give tls://HOST:PORT, or tcp://127\.0\.0\.1:PORT"
    ):
        choose_workers(None, address)


def test_a_number_of_workers_beside_a_scheduler_is_refused() -> None:
    with pytest.raises(
        BadUsage, match="^--workers is how many processes work here, but --scheduler has workers of its"
    ):
        choose_workers(2, "tcp://127.0.0.1:8786")


def test_a_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(BadUsage, match=r"^a scheduler needs Dask; install it: pip install 'greywhale\[cluster\]'\.$"):
        choose_workers(None, "tcp://127.0.0.1:8786")
