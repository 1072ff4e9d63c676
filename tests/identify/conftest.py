"""Recordings of an arm that only this file knows; one identification that several tests look at."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale.arm import ArmParameters
from greywhale.files.arm import load_arm
from greywhale.identify import Outcome, identify
from greywhale.table import ParameterTable
from tools.bench.recordings import Recorded, random_arm, record_three, table_of

HIDDEN_SEED = 2
SECONDS = 10.0


@pytest.fixture(scope="session")
def hidden() -> ArmParameters:
    """The truth; tests may compare with it, the identification never gets it."""
    return random_arm(HIDDEN_SEED)


@pytest.fixture(scope="session")
def white_box() -> ArmParameters:
    return load_arm("white_box")


@pytest.fixture(scope="session")
def log_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("recordings")


@pytest.fixture(scope="session")
def recorded(hidden: ArmParameters, log_folder: Path) -> Recorded:
    return record_three(hidden, log_folder, seed=1, seconds=SECONDS)


@pytest.fixture(scope="session")
def tables() -> list[ParameterTable]:
    return [table_of(name) for name in ("before_tuning", "table_10")]


@pytest.fixture(scope="session")
def outcome(recorded: Recorded, white_box: ArmParameters, tables: list[ParameterTable]) -> Outcome:
    return identify([recorded.fit], white_box, validate=[recorded.second, recorded.changed], tables=tables)
