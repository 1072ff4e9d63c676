"""Pulses of one motor tell its direction rightly, whatever else moves the arm. Their limits: test_pulse_on_pins.py."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.board.calibrate.motors import examine_motor
from greywhale.board.device import Device
from greywhale.board.upload import read_parameters
from greywhale.files.arm import default_arm
from greywhale.protocol.table import ParameterTable
from tools.support.calibrating_person import bench_of

pytestmark = pytest.mark.slow


def sinking(seed: int) -> ArmParameters:
    """An arm whose gears do not hold it, with motors of uneven strength."""
    random = np.random.default_rng(seed)
    data = default_arm().model_dump()
    for one in data["joint"]:
        one["friction"]["coulomb"] *= 0.3
        one["friction"]["breakaway"] *= 0.3
        one["motor"]["resistance"] *= float(random.uniform(1.0, 2.5))
    return ArmParameters.model_validate(data, strict=False)


def test_an_arm_that_sinks_while_it_is_pulsed_is_told_right(tmp_path: Path) -> None:
    """It is held level, as nobody should: it falls in some pulses, and lies still in others."""
    with bench_of(sinking(seed=2), tmp_path) as bench:
        bench.command("hand follower 0.3 0.2 -0.4 0.2")
        bench.command("motor 2 reversed")
        with Device(bench.port) as device:
            table = read_parameters(device)
            assert [examine_motor(device, table, joint).sign for joint in (1, 2)] == [1, -1]


@pytest.mark.parametrize("falling", [0, 1, 2, 3])
def test_a_joint_that_falls_in_one_pulse_is_not_taken_for_one_that_the_motor_moves(
    monkeypatch: pytest.MonkeyPatch, falling: int
) -> None:
    """Whichever of the first pulses it is: neither swapped motors nor a direction follow from that."""
    table, pulses = ParameterTable.defaults(), iter(range(1000))

    def scripted(device: object, weak: ParameterTable, joint: int, way: int) -> Floats:
        moved = np.array([0.05 * way * (weak.each("joint", "ku_mv")[0] > 3000), 0.0, 0.0, 0.0])
        moved[1] = -0.1 if next(pulses) == falling else 0.0
        return moved

    monkeypatch.setattr("greywhale.board.calibrate.motors.pulse", scripted)
    device: Any = SimpleNamespace(port="port")
    found = examine_motor(device, table, 0)
    assert found.sign == 1
    assert found.volts == pytest.approx(0.25 * table.supply_v)
    pulses = iter(range(1000))
    with pytest.raises(UserError, match="the motor of joint 1 did not move it"):
        examine_motor(device, table, 1)
