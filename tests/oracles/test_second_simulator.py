"""Another simulator of the ATmega328P runs our image: the same duties, to the tick, and the same EEPROM."""

from __future__ import annotations

import json
import struct
import subprocess

import numpy as np
import pytest

from greywhale.protocol import frames, schema
from greywhale.protocol.frames import Frame
from tests.oracles.second_simulator import (
    CHANNELS,
    CONVERSIONS,
    IMAGE,
    NODE,
    SCRIPTS,
    Run,
    Scenario,
    Volts,
    parameter_requests,
    request,
    run_avr8js,
    run_board,
)

TICKS = 4000
# The followers of this scenario move without their motors.
UNWATCHED = {"speed_limit": 0, "runaway_limit": 0, "stall_volts": 0, "unrest_amplitude": 0}
NEW_SET = UNWATCHED | {
    "filter_shift": 2,
    "joint0.kp": 90_000,
    "joint1.ki": 3_000_000,
    "joint2.ku_mv": 12_000,
    "joint3.motor_sign": -1,
    "tracking_ms": 40,
}
RUNNING = [NEW_SET.get(parameter.name, parameter.default) for parameter in schema.PARAMETERS]
BANK_A, MAGIC = 16, b"GW"
COUNT = 5 / 1024  # volts
APPLYING = (range(50, 100), range(1540, 1620))  # ticks, until the filter of a new set has settled


def bad_following() -> Volts:
    """Four joints that follow badly: slow swings, steps, noise on each conversion, a pot at its rail, a lost joint."""
    random = np.random.default_rng(4)
    tick = np.arange(TICKS)
    counts = np.zeros((TICKS, CONVERSIONS, CHANNELS))
    for joint in range(4):
        leader = 512 + 120 * np.sin(tick / (70 + 30 * joint) + joint) + 40 * (tick // 400 % 2)
        follower = np.roll(leader, 30 + 7 * joint) + 15 * np.sin(tick / 9)
        follower[:200] = leader[:200] + 20
        counts[:, :, joint] = leader[:, None]
        counts[:, :, 4 + joint] = follower[:, None]
    counts += random.integers(-3, 4, counts.shape)
    counts[2600:2606, :, 5] = 1023  # longer than a rail may last
    counts[3400:, :, 2] += 300  # beyond the tracking limit for good
    volts: Volts = ((np.floor(counts.clip(0, 1023)) + 0.5) * COUNT).astype(np.float32)
    return volts


def all_requests() -> dict[int, bytes]:
    enable = request(schema.EnableRequest, 2, struct.pack("<H", 0))
    # While samples are on their way: both directions of the line are busy.
    sends = {
        tick: request(schema.ParamGetRequest, tick & 0xFF, struct.pack("<H", tick % 80)) for tick in range(200, 1400)
    }
    sends |= {
        40: request(schema.TelemetryRequest, 1, struct.pack("<H", 1)),
        120: enable,
        1500: request(schema.StopRequest, 3),
        1630: request(schema.ParamSaveRequest, 6),
        1700: enable,
        2700: request(schema.ClearFaultRequest, 4),
        2720: enable,
        3950: request(schema.TelemetryRequest, 5, struct.pack("<H", 0)),
    }
    sends |= {44 + 4 * i: data for i, data in enumerate(parameter_requests(UNWATCHED, 30))}
    return sends | {1510 + 4 * i: data for i, data in enumerate(parameter_requests(NEW_SET, 10))}


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> tuple[Run, Run]:
    scenario = Scenario(bad_following(), all_requests())
    return run_avr8js(scenario, tmp_path_factory.mktemp("avr8js")), run_board(scenario)


def test_both_simulators_give_the_same_outputs_in_every_tick(runs: tuple[Run, Run]) -> None:
    theirs, ours = runs
    different = np.nonzero(np.any(theirs.outputs != ours.outputs, axis=1))[0]
    assert theirs.outputs.shape == ours.outputs.shape == (TICKS, 6)
    assert len(different) == 0, f"tick {different[0]}: {theirs.outputs[different[0]]} and {ours.outputs[different[0]]}"


def frames_of(sent: bytes) -> tuple[list[Frame], dict[bytes, Frame]]:
    """Replies in their order, and samples by their tick."""
    found = list(frames.FrameDecoder().feed(sent))
    samples = {frame.payload[:4]: frame for frame in found if frame.type == schema.Sample.TYPE}
    return [frame for frame in found if frame.type != schema.Sample.TYPE], samples


def test_both_simulators_send_the_same_replies_and_samples(runs: tuple[Run, Run]) -> None:
    """Interrupts take two cycles more on one of them. So a piece of work that is due at 800 us may begin in a tick or
    not: replies and samples may change places. A set may be applied a tick later, with its filter.
    """
    (replies, samples), (our_replies, our_samples) = (frames_of(run.sent) for run in runs)
    assert replies == our_replies
    common = samples.keys() & our_samples.keys()
    steady = [key for key in common if not any(int.from_bytes(key, "little") in span for span in APPLYING)]
    assert all(samples[tick].payload == our_samples[tick].payload for tick in steady)
    assert len(steady) > 3700
    assert len(samples.keys() ^ our_samples.keys()) <= 10


def test_both_simulators_store_the_same_set(runs: tuple[Run, Run]) -> None:
    theirs, ours = runs
    bank, _, written = ours.eeprom[BANK_A:].partition(schema.TABLE.pack(RUNNING))
    assert bank[:2] == MAGIC
    assert written
    assert theirs.eeprom == ours.eeprom


def test_the_scenario_shows_what_it_is_for(runs: tuple[Run, Run]) -> None:
    """Motors on three times, four duties that differ all the time, both directions, two faults."""
    _, ours = runs
    drivers = ours.outputs[:, 4] >> 4 & 1
    assert np.count_nonzero(np.diff(drivers) == 1) == 3
    assert list(drivers[[1499, 2600, 3399]]) == [1, 1, 1]
    assert list(drivers[[1501, 2604, 3450]]) == [0, 0, 0]
    following = ours.outputs[drivers == 1]
    assert all(len(np.unique(following[:, column])) > 100 for column in range(4))


def test_the_pins_carry_the_duties_of_the_compare_registers() -> None:
    """By the other simulator's own timers: 20 kHz from timer 1, 31.4 kHz from timer 2, mean levels to 0.5 %.

    Before the board is enabled, no pin moves.
    """
    enable = request(schema.EnableRequest, 1, struct.pack("<H", 0))
    command = ["node", str(SCRIPTS / "pwm.js"), str(IMAGE), enable.hex()]
    found = json.loads(subprocess.run(command, env=NODE, check=True, capture_output=True, text=True).stdout)
    assert not found["early"]
    for pin, top in zip(found["pins"], (400, 400, 255, 255), strict=True):
        assert pin["compare"] > 0.02 * top
        assert pin["period"] == pytest.approx(2 * top, rel=1e-3)
        assert pin["mean"] == pytest.approx(pin["compare"] / top, abs=5e-3)
