"""A tuning that nobody ran, for what is said of one."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.tune.result import TuningResult
from tests.tune.models import judged, log_facts, write_model


@pytest.fixture
def outcome(tmp_path: Path) -> TuningResult:
    """It is of a model that was not validated."""
    return judged(write_model(tmp_path / "model.toml", log=[log_facts()]))
