"""The emergency stop on the real images: from the pin going low to no duty, at any moment of a tick."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.protocol import schema
from greywhale_sim.board_with_image import BoardWithImage
from tests.firmware.conftest import apply, enable, ms_until_off

PHASES = 30
TICK_AND_ITS_WORK_MS = 1.06  # the pin is read once in each tick, after the potentiometers
OPENING = 2


def press(bench: BoardWithImage, low: bool = True) -> None:
    pin = bench.wiring.estop
    bench.board.hold_pin(pin.port, pin.bit, not low)


def release(bench: BoardWithImage) -> None:
    pin = bench.wiring.estop
    bench.board.let_pin_go(pin.port, pin.bit)


def drive(bench: BoardWithImage) -> None:
    """Motors on, with a duty on joint 0: its leader is 0.2 rad away."""
    bench.millivolts[0] = 2700.0
    bench.board.set_millivolts(bench.millivolts)
    bench.wait(30)
    enable(bench)
    bench.wait(bench.random.uniform(120, 125))
    assert bench.duty() > 0.0


@pytest.mark.slow
def test_motors_are_off_within_a_tick_of_the_pin_going_low(bench: BoardWithImage) -> None:
    took = []
    for _ in range(PHASES):
        drive(bench)
        press(bench)
        took.append(ms_until_off(bench))
        release(bench)
    seen = bench.status()
    assert (seen.state, seen.fault, seen.stop_reason) == (
        schema.State.FAULT,
        schema.Fault.ESTOP,
        schema.StopReason.FAULT,
    )
    assert seen.late_ticks == 0
    assert max(took) <= TICK_AND_ITS_WORK_MS
    assert np.ptp(took) > 0.9, "the presses came in all phases of the tick"


def test_a_stop_that_is_pressed_through_a_reset_cannot_be_cleared_and_keeps_the_motors_off_when_released(
    bench: BoardWithImage,
) -> None:
    press(bench)
    bench.board.reset()
    bench.wait(60)
    assert (bench.status().state, bench.status().fault) == (schema.State.FAULT, schema.Fault.ESTOP)
    with pytest.raises(RuntimeError, match="ClearFault"):
        bench.ask(schema.ClearFaultRequest())
    release(bench)
    bench.wait(5)
    with pytest.raises(RuntimeError, match="Enable"):
        bench.ask(schema.EnableRequest(0))
    enable(bench)


def test_an_opening_button_stops_when_it_opens_or_its_wire_breaks(bench: BoardWithImage) -> None:
    apply(bench, "estop_input", OPENING)
    assert bench.status().fault is schema.Fault.ESTOP, "nothing is wired: the pull-up holds the pin high"
    press(bench, low=True)
    bench.wait(2)
    drive(bench)
    release(bench)
    assert ms_until_off(bench) <= TICK_AND_ITS_WORK_MS


def test_without_a_stop_the_pin_means_nothing(bench: BoardWithImage) -> None:
    apply(bench, "estop_input", 0)
    press(bench)
    drive(bench)
    bench.wait(20)
    assert bench.motors_on
    release(bench)
    bench.wait(20)
    assert bench.motors_on
