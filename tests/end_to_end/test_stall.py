"""The limit of a stall that tune writes: the real firmware with a heavy arm, and with a blocked one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.files.arm import load_arm
from greywhale.files.leader import save_leader
from greywhale.files.model import to_toml
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.schema import Fault, State
from greywhale.protocol.table import ParameterTable
from greywhale.tune.stall import stall_limit
from tests.end_to_end.test_lock_step import set_parameters
from tests.tune.models import facts_of

TIP = 0.9  # kg
ARM = load_arm("default").model_copy(update={"tip": load_arm("default").tip.model_copy(update={"mass": TIP})})
IDENTIFIED = ARM.model_copy(update={"identification": facts_of(ARM)})


class Stuck:
    """An arm one of whose joints cannot turn from some moment on."""

    def __init__(self, arm: Any, joint: int) -> None:
        self.arm, self.joint = arm, joint
        self.at: float | None = None

    def step(self, voltages: np.ndarray, dt: float) -> np.ndarray:
        angles = np.array(self.arm.step(voltages, dt))
        if self.at is not None:
            angles[self.joint] = self.at
        return angles

    def __getattr__(self, name: str) -> Any:
        return getattr(self.arm, name)


@pytest.fixture
def files(tmp_path: Path) -> dict[str, Path]:
    """The arm, and a leader that lifts both pitch joints to level, and waits there."""
    (tmp_path / "arm.toml").write_text(to_toml(ARM, {}), encoding="utf-8")
    time_s = np.arange(0.0, 4.001, 0.01)
    raised = np.clip(time_s / 2.0, 0.0, 1.0)[:, None]
    low, level = np.array([0.0, -0.7, -0.4, 0.0]), np.zeros(4)
    save_leader(tmp_path / "leader.csv", Trajectory(time_s, low + raised * (level - low)))
    return {"arm": tmp_path / "arm.toml", "leader": tmp_path / "leader.csv"}


def lift(host: Any, stall_volts: int) -> tuple[Fault, int]:
    """The fault and its joint after the arm was lifted to level and held there."""
    set_parameters(host, {"stall_volts": stall_volts})
    host.follow()
    host.run(5.0)
    status = host.status()
    assert (status.state is State.FAULT) == (status.fault is not Fault.NONE)
    return status.fault, status.fault_where


def tuned() -> int:
    limit = stall_limit(IDENTIFIED, ParameterTable.defaults())
    assert limit is not None
    return limit.raw


@pytest.mark.slow
def test_a_heavy_arm_is_no_stall_with_the_limit_of_its_model(lock_step: Any, files: dict[str, Path]) -> None:
    as_shipped, _ = lift(lock_step(**files), ParameterTable.defaults()["stall_volts"])
    assert as_shipped is Fault.STALLED, "or this arm would not show what the limit is for"
    assert lift(lock_step(**files), tuned())[0] is Fault.NONE


@pytest.mark.slow
@pytest.mark.parametrize("joint", [1, 2])
def test_a_blocked_joint_is_one(lock_step: Any, files: dict[str, Path], joint: int) -> None:
    host = lock_step(**files)
    stuck = Stuck(host.bench.plant, joint)
    host.bench.plant = stuck
    set_parameters(host, {"stall_volts": tuned()})
    host.follow()
    stuck.at = float(host.bench.angles[joint])
    host.run(5.0)
    assert (host.status().fault, host.status().fault_where) == (Fault.STALLED, joint)
    assert not host.bench.motors_enabled
