"""The boards that the firmware is built for."""

from __future__ import annotations

import pytest

from tools.bench.bench_tick import BOARDS, Bench


@pytest.fixture(params=BOARDS)
def bench(request: pytest.FixtureRequest) -> Bench:
    """The real image on a simulated chip, booted, motors off."""
    return Bench(request.param)
