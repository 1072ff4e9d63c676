"""The processes of a study begin and end whole, whenever Ctrl-C comes."""

from __future__ import annotations

import contextlib
import gc
import signal
from multiprocessing import resource_tracker

import pytest

from greywhale.base.study import LocalWorkers


def test_ctrl_c_while_the_pool_is_made_loses_no_semaphore(monkeypatch: pytest.MonkeyPatch) -> None:
    left: list[str] = []
    register, unregister = resource_tracker.register, resource_tracker.unregister

    def interrupted(name: str, kind: str) -> None:
        register(name, kind)
        left.append(name)
        signal.raise_signal(signal.SIGINT)  # before whoever made it knows that it is entered

    def removed(name: str, kind: str) -> None:
        unregister(name, kind)
        left.remove(name)

    monkeypatch.setattr(resource_tracker, "register", interrupted)
    monkeypatch.setattr(resource_tracker, "unregister", removed)
    with contextlib.suppress(KeyboardInterrupt), LocalWorkers(2).executor():
        pytest.fail("nobody was interrupted")
    gc.collect()
    assert left == []
