"""The firmware inside a page gives what its image gives on a board: the same duties and frames, tick by tick.

The same requests and voltages go through the module in Node.js, through the Mega's image on our board and through the
Nano's in avr8js. Left out is what the cycles of a processor decide, and the board's name: in hello `board` and
`reset_cause`, in status `tick_us_max` and `telemetry_dropped`, and samples while a set is being applied. That takes a
board some ticks, and the page less.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.types import Floats
from greywhale.files.arm import default_arm
from greywhale.protocol import schema
from greywhale.protocol.frames import Frame
from greywhale_sim._board import Board
from greywhale_sim.programs import load_hex
from greywhale_sim.wiring import MEGA
from tests.oracles.page_bench import TICK_SLICES, PageBench
from tests.oracles.second_simulator import (
    CHANNELS,
    CONVERSIONS,
    ROOT,
    Run,
    Scenario,
    request,
    run_avr8js,
    run_image,
    send_at,
)
from tests.oracles.test_second_simulator import APPLYING, TICKS, all_requests, bad_following, frames_of

IMAGE = ROOT / "firmware/.pio/build" / MEGA.environment / "firmware.hex"
TICK_VECTOR = 21 * 4
SLICE_CYCLES = 4000
SLICE_OF = np.array([(135 + 26 * conversion) // 250 for conversion in range(CONVERSIONS)])
FIRST_OF = np.array([np.argmax(one == SLICE_OF) for one in range(TICK_SLICES)])  # conversion of each slice
PINS = slice(20, 29)  # of what the module shows: enable, duties, directions
LEAST_STEADY = 3700
FLOATING_TICKS = 150
COUNTS_APART = 40  # of 4096 a rad
STATUS_AT = (130, 1000, 1495, 2650, 3940)


def slices_scenario() -> Scenario:
    """Voltages that change from slice to slice, as on a bench."""
    sends = all_requests() | {20: request(schema.HelloRequest, 90)}
    sends |= {tick: request(schema.StatusRequest, 91) for tick in STATUS_AT}
    return Scenario(bad_following()[:, FIRST_OF[SLICE_OF]], sends)


def run_page(scenario: Scenario) -> Run:
    outputs, sent = [], b""
    with PageBench(default_arm()) as bench:
        bench.calls([["let_float", pot, scenario.floating >> pot & 1] for pot in range(CHANNELS)])
        bench.calls([["put", [2500.0] * 8], ["hold_inputs"], ["power", 1], ["run", TICK_SLICES]])
        for tick, volts in enumerate(scenario.volts):
            for part, conversion in enumerate(FIRST_OF):
                millivolts = (1000.0 * volts[conversion].astype(float)).tolist()
                if tick in scenario.sends and send_at(tick) // SLICE_CYCLES == part:
                    bench.call("send", scenario.sends[tick].hex())
                said = bench.calls([["put", millivolts], ["hold_inputs"], ["run", 1]])[-1]
                sent += bytes.fromhex(said)
            outputs.append(bench.call("look")[PINS])
    return Run(np.array(outputs), sent)


def run_mega(scenario: Scenario) -> Run:
    board = Board(MEGA.mcu)
    load_hex(board, IMAGE)
    board.add_pin_output(MEGA.enable.port, MEGA.enable.bit)
    for motor in MEGA.motors:
        board.add_duty_output(motor.pwm.timer, motor.pwm.channel)
    for motor in MEGA.motors:
        board.add_pin_output(motor.direction.port, motor.direction.bit)
    return run_image(board, TICK_VECTOR, scenario, lambda: board.outputs().tolist())


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return slices_scenario()


@pytest.fixture(scope="module")
def page(scenario: Scenario) -> Run:
    return run_page(scenario)


def without_cycles(frame: Frame) -> object:
    """A reply without what only a board with cycles can say; its work can put an answer off to the next tick."""
    if frame.type == schema.HelloReply.TYPE:
        hello = schema.HelloReply.unpack(frame.payload)
        return replace(hello, board=schema.Board.UNKNOWN, reset_cause=schema.ResetCause.UNKNOWN)
    if frame.type == schema.StatusReply.TYPE:
        status = schema.StatusReply.unpack(frame.payload)
        return replace(status, tick=0, tick_us_max=0, telemetry_dropped=0)
    return frame


def require_same_frames(page: Run, other: Run) -> None:
    (replies, samples), (their_replies, their_samples) = (frames_of(run.sent) for run in (page, other))
    assert [without_cycles(frame) for frame in replies] == [without_cycles(frame) for frame in their_replies]
    assert steady(samples) == steady(their_samples)


def steady(samples: dict[bytes, Frame]) -> dict[int, bytes]:
    """Samples by their tick, without those from while a set is being applied."""
    found = {int.from_bytes(tick, "little"): frame.payload for tick, frame in samples.items()}
    kept = {tick: payload for tick, payload in found.items() if not any(tick in span for span in APPLYING)}
    assert len(kept) > LEAST_STEADY
    return kept


def at_motors(run: Run) -> Floats:
    """Enable, and duties with their sign: the direction of a duty of 0 means nothing, and differs."""
    enable, duties, directions = run.outputs[:, :1], run.outputs[:, 1:5], run.outputs[:, 5:]
    return np.hstack([enable, duties * (2 * directions - 1)])


def test_the_page_and_the_megas_image_give_the_same_frames_and_pins(scenario: Scenario, page: Run) -> None:
    mega = run_mega(scenario)
    require_same_frames(page, mega)
    assert page.outputs.shape == mega.outputs.shape == (TICKS, 9)
    assert np.nonzero(np.any(at_motors(page) != at_motors(mega), axis=1))[0].tolist() == []


def test_the_page_and_the_nanos_image_in_avr8js_give_the_same_frames(
    scenario: Scenario, page: Run, tmp_path: Path
) -> None:
    require_same_frames(page, run_avr8js(scenario, tmp_path))


def test_an_input_without_a_wire_reads_what_the_one_before_left(scenario: Scenario) -> None:
    """The first of the followers, the first of the leaders, and two in a row."""
    short = Scenario(scenario.volts[:FLOATING_TICKS], {40: scenario.sends[40]}, floating=0b0101_0011)
    (_, samples), (_, theirs) = (frames_of(run(short).sent) for run in (run_page, run_mega))
    assert samples == theirs
    angles = [schema.Sample.unpack(frame.payload).leader for frame in samples.values()]
    assert len(angles) > FLOATING_TICKS / 2
    assert all(abs(first - second) < COUNTS_APART for first, second, *_ in angles)
