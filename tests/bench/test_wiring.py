"""The wiring tables: no pin twice, the same in README.md."""

from __future__ import annotations

from pathlib import Path

import pytest

from greywhale_sim.wiring import BOARDS, Wiring, markdown_table

ROOT = Path(__file__).resolve().parents[2]
# Which compare output is on which Arduino pin, from the boards' own pin tables.
PWM_PINS = {
    "mega": {"D5": (3, "A"), "D6": (4, "A"), "D7": (4, "B"), "D8": (4, "C")},
    "nano": {"D9": (1, "A"), "D10": (1, "B"), "D11": (2, "A"), "D3": (2, "B")},
}
SERIAL_PINS = {"D0", "D1"}


@pytest.mark.parametrize("wiring", BOARDS.values(), ids=BOARDS.keys())
def test_every_wire_has_a_pin_of_its_own(wiring: Wiring) -> None:
    pins = [motor.pwm_arduino for motor in wiring.motors] + [motor.direction.arduino for motor in wiring.motors]
    pins += [wiring.enable.arduino, wiring.led.arduino, wiring.estop.arduino]
    assert len(set(pins)) == 11
    assert not SERIAL_PINS & set(pins)
    bits = [(motor.direction.port, motor.direction.bit) for motor in wiring.motors]
    others = [(pin.port, pin.bit) for pin in (wiring.enable, wiring.led, wiring.estop)]
    assert len({*bits, *others}) == 7


@pytest.mark.parametrize("wiring", BOARDS.values(), ids=BOARDS.keys())
def test_pwm_pins_are_those_of_the_timers(wiring: Wiring) -> None:
    assert {motor.pwm_arduino: (motor.timer, motor.channel) for motor in wiring.motors} == PWM_PINS[wiring.name]


def test_readme_shows_this_table() -> None:
    assert markdown_table() in (ROOT / "README.md").read_text(encoding="utf-8")
