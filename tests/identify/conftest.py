"""Recordings of an arm that only this file knows, of all of it and of its shoulder alone; one identification that
several tests look at.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.files.arm import load_arm
from greywhale.files.log import Log
from greywhale.files.trajectory import Trajectory
from greywhale.identify import IdentificationResult, bootstrap, identify
from greywhale.loop import human_reaches
from greywhale.protocol.table import ParameterTable
from tools.support.recordings import Recorded, random_arm, record, record_three, table_of

HIDDEN_SEED = 2
SECONDS = 9.0


def alone(motion: Trajectory, joints: Sequence[int] = (1,)) -> Trajectory:
    """Only these joints are led, and so only these are identified: in a fraction of the time, by the same steps."""
    return replace(motion, angles=motion.angles * np.isin(np.arange(4), joints))


def rows(log: Log, kept: np.ndarray | slice) -> Log:
    columns = {name: getattr(log, name)[kept] for name in ("time", "leader", "follower", "voltage", "state")}
    return replace(log, **columns)


def first(log: Log, seconds: float) -> Log:
    return rows(log, slice(None, int(np.searchsorted(log.time, seconds))))


def without(log: Log, share: float) -> Log:
    return rows(log, np.random.default_rng(1).random(len(log.time)) >= share)


@contextmanager
def simulated_logs(count: int) -> Iterator[None]:
    """What fits are off is measured on so many simulated logs instead of six: no number here hangs on how well."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bootstrap, "LOGS", count)
        yield


@pytest.fixture(autouse=True)
def _no_simulated_logs() -> Iterator[None]:
    with simulated_logs(0):
        yield


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
def shoulder(hidden: ArmParameters, tables: list[ParameterTable], log_folder: Path) -> Recorded:
    """The same arm led by its shoulder alone."""

    def log(name: str, table: ParameterTable, seed: int) -> Log:
        return record(hidden, alone(human_reaches(seed, 7.0)), log_folder / f"shoulder_{name}.csv", table, seed)

    return Recorded(log("fit", tables[0], 21), log("second", tables[0], 22), log("changed", tables[1], 23))


@pytest.fixture(scope="session")
def shoulder_outcome(
    shoulder: Recorded, white_box: ArmParameters, tables: list[ParameterTable]
) -> IdentificationResult:
    """From every third row or so, one to five ticks apart, a twentieth of them lost."""
    chosen = np.cumsum(np.random.default_rng(3).integers(1, 6, len(shoulder.fit.time)))
    log = without(rows(shoulder.fit, chosen[chosen < len(shoulder.fit.time)]), 0.05)
    with simulated_logs(0):
        return identify([log], white_box, validate=[shoulder.second], tables=tables)


@pytest.fixture(scope="session")
def tables() -> list[ParameterTable]:
    return [table_of(name) for name in ("before_tuning", "table_10")]


@pytest.fixture(scope="session")
def outcome(recorded: Recorded, white_box: ArmParameters, tables: list[ParameterTable]) -> IdentificationResult:
    """With deviations that one simulated log widens."""
    with simulated_logs(1):
        return identify([recorded.fit], white_box, validate=[recorded.second, recorded.changed], tables=tables)
