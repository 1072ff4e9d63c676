"""One simulated bench for all tests of a file, and where a log goes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from greywhale.cli.story import RunningBench
from greywhale_sim.words import lock_step


@pytest.fixture(scope="module")
def bench() -> Iterator[RunningBench]:
    with lock_step() as started:
        yield started


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path / "log.csv"
