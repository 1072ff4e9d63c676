"""Pulses of one motor: the firmware keeps voltage, time and way within their limits, whatever is wired wrongly."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.base.errors import UserError
from greywhale.board.calibrate.motors import FARTHEST_RAD, LEASE_MS, SHARES, Pulse, examine_motor, pulse, pulse_table
from greywhale.board.device import Device
from greywhale.board.upload import read_parameters, run_set
from greywhale.cli.story import RunningBench
from greywhale.files.arm import default_arm
from greywhale.protocol import schema
from greywhale.protocol.table import ParameterTable
from tools.support.hands import bench_of

pytestmark = pytest.mark.slow


MOVING = (schema.State.SOFT_START, schema.State.FOLLOWING)


@pytest.fixture
def device(bench: RunningBench) -> Iterator[Device]:
    with Device(bench.port) as opened:
        yield opened
    for joint in range(4):
        bench.command(f"motor {joint} connected")


def test_the_firmware_ends_a_pulse_without_its_host(device: Device) -> None:
    """Of a host that asks for nothing more after the point."""
    run_set(device, pulse_table(read_parameters(device), 3, 1.5))
    device.telemetry(1)
    begun = device.lead(LEASE_MS)
    device.lead_point(begun.next, (0, 0, 0, 80))
    samples: list[schema.Sample] = []
    while not samples or samples[-1].tick - samples[0].tick < 500:
        samples += device.samples()
    moving = [one.tick for one in samples if one.state in MOVING]
    assert moving[-1] - moving[0] <= LEASE_MS
    assert samples[-1].state is schema.State.DISABLED


def test_the_set_of_a_pulse_gives_one_motor_few_volts_and_the_others_none() -> None:
    table = pulse_table(ParameterTable.defaults(), 2, 2.5)
    assert table.each("joint", "ku_mv") == (0, 0, 2500, 0)
    assert set(table.each("joint", "ki")) == set(table.each("joint", "kd")) == {0}
    assert table.physical("tracking_limit") == pytest.approx(FARTHEST_RAD, abs=1e-3)
    assert table["tracking_ms"] == 1


def test_an_arm_that_gravity_moves_more_than_the_pulse_is_told_right(bench: RunningBench, device: Device) -> None:
    """A pulse up and a pulse down both end below: their difference counts."""
    table = read_parameters(device)
    weak = pulse_table(table, 1, SHARES[0] * table.supply_v)
    ways = np.array([pulse(device, weak, 1, way).moved[1] for way in (1, -1)])
    assert abs(ways.sum()) > 0.05, "gravity shows"
    assert examine_motor(device, table, 1).sign == 1


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

    def scripted(device: object, weak: ParameterTable, joint: int, way: int) -> Pulse:
        moved = np.array([0.05 * way * (weak.each("joint", "ku_mv")[0] > 3000), 0.0, 0.0, 0.0])
        moved[1] = -0.1 if next(pulses) == falling else 0.0
        return Pulse(moved, 0.0)

    monkeypatch.setattr("greywhale.board.calibrate.motors.pulse", scripted)
    device: Any = SimpleNamespace(port="port")
    found = examine_motor(device, table, 0)
    assert found.sign == 1
    assert found.volts == pytest.approx(0.25 * table.supply_v)
    pulses = iter(range(1000))
    with pytest.raises(UserError, match="the motor of joint 1 did not move it"):
        examine_motor(device, table, 1)
