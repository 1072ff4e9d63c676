"""One simulated bench for all tests of a file, its board shared."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

import pytest

from greywhale_sim.lockstep import LockStepBench
from greywhale_sim.words import lock_step
from tests.dashboard.shared import Desk, Shared, living


@pytest.fixture(scope="module")
def bench() -> Iterator[LockStepBench]:
    with lock_step() as started:
        yield started


@pytest.fixture
def shared(bench: LockStepBench) -> Iterator[Shared]:
    with Shared(bench.port) as board:
        yield board


@pytest.fixture
def desk(shared: Shared, tmp_path: Path) -> Iterator[Desk]:
    desk = Desk(shared, tmp_path)
    with living(shared), contextlib.closing(desk.jobs):
        yield desk
