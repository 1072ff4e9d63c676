"""Pulses of one motor: the firmware keeps voltage, time and way within their limits, whatever is wired wrongly."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from greywhale.board.device import Device
from greywhale.board.upload import read_parameters, run_set
from greywhale.calibrate.motors import FARTHEST_RAD, LEASE_MS, SHARES, examine_motor, pulse, pulse_table
from greywhale.demo import BenchProcess
from greywhale.errors import UserError
from greywhale.protocol import schema
from greywhale.table import ParameterTable

# At the strongest pulse a motor that runs away is at 5 rad/s when it is stopped, and coasts.
WITH_COASTING_RAD = 0.45
MOVING = (schema.State.SOFT_START, schema.State.FOLLOWING)


@pytest.fixture(scope="module")
def bench() -> Iterator[BenchProcess]:
    with BenchProcess("--speed", "max") as started:
        yield started


@pytest.fixture
def device(bench: BenchProcess) -> Iterator[Device]:
    with Device(bench.port) as opened:
        yield opened
    for joint in range(4):
        bench.command(f"motor {joint} connected")


@pytest.mark.parametrize("wiring", ["connected", "reversed"])
@pytest.mark.parametrize("joint", range(4))
def test_no_pulse_exceeds_its_voltage_or_its_way(bench: BenchProcess, device: Device, joint: int, wiring: str) -> None:
    table = read_parameters(device)
    bench.command(f"motor {joint} {wiring}")
    for share in SHARES:
        volts = share * table.supply_v
        for way in (1, -1):
            done = pulse(device, pulse_table(table, joint, volts), joint, way)
            assert done.most_v <= volts + 0.001
            assert abs(done.moved[joint]) <= WITH_COASTING_RAD
            assert not bench.command("status")["motors_enabled"]


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


@pytest.mark.parametrize("joint", range(4))
def test_each_motor_is_told_by_its_sign(bench: BenchProcess, device: Device, joint: int) -> None:
    table = read_parameters(device)
    assert examine_motor(device, table, joint).sign == 1
    bench.command(f"motor {joint} reversed")
    assert examine_motor(device, table, joint).sign == -1
    assert examine_motor(device, table.with_raw({f"joint{joint}.motor_sign": -1}), joint).sign == 1


def test_an_arm_that_gravity_moves_more_than_the_pulse_is_told_right(bench: BenchProcess, device: Device) -> None:
    """A pulse up and a pulse down both end below: their difference counts."""
    table = read_parameters(device)
    weak = pulse_table(table, 1, SHARES[0] * table.supply_v)
    ways = np.array([pulse(device, weak, 1, way).moved[1] for way in (1, -1)])
    assert abs(ways.sum()) > 0.05, "gravity shows"
    assert examine_motor(device, table, 1).sign == 1


@pytest.mark.parametrize(("one", "other"), [(0, 1), (1, 2), (2, 3)])
def test_swapped_motors_are_named(bench: BenchProcess, device: Device, one: int, other: int) -> None:
    bench.command(f"motor {one} {other}")
    bench.command(f"motor {other} {one}")
    with pytest.raises(UserError, match=f"the motor of joint {one} moved joint {other}"):
        examine_motor(device, read_parameters(device), one)


@pytest.mark.parametrize("joint", range(4))
def test_a_dead_motor_is_named(bench: BenchProcess, device: Device, joint: int) -> None:
    bench.command(f"motor {joint} dead")
    with pytest.raises(UserError, match=f"the motor of joint {joint} did not move it with 5.2 V"):
        examine_motor(device, read_parameters(device), joint)
