"""What the tests of adaptations share: a model that knows the default arm, and a person at work with it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from greywhale.adapt.decide import Adaptation
from greywhale.files.arm import default_arm
from greywhale.protocol.table import ParameterTable
from greywhale.tune.model import Model, load_model
from tests.adapt.simulated import Work
from tests.tune.models import write_model

TABLE = ParameterTable.defaults()


@pytest.fixture(scope="session")
def model(tmp_path_factory: pytest.TempPathFactory) -> Model:
    """Of the default arm, which it knows exactly."""
    path: Path = write_model(tmp_path_factory.mktemp("model") / "model.toml")
    return replace(load_model(path, force=True), table=TABLE)


@pytest.fixture
def adaptation(model: Model) -> Adaptation:
    return Adaptation(model, TABLE, budget=1)


@pytest.fixture
def work() -> Work:
    return Work(default_arm())
