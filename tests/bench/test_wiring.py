"""The wiring tables: no pin twice, the same in docs/your-arm.md."""

from __future__ import annotations

import re

import pytest

from greywhale_sim.wiring import BOARDS, MEGA, NANO, Motor, Pin, Pwm, Wiring, markdown_table
from tools import ROOT

# Which compare output is on which Arduino pin, from the boards' own pin tables.
PWM_PINS = {
    "mega": {"D5 3A", "D6 4A", "D7 4B", "D8 4C", "D2 3B", "D46 5A", "D45 5B", "D44 5C"},
    "nano": {"D9 1A", "D10 1B", "D11 2A", "D3 2B"},
}
SERIAL_PINS = {"D0", "D1"}


def wires(motor: Motor) -> list[Pin | Pwm]:
    return [one for one in (motor.pwm, motor.direction, motor.second_pwm, motor.second_direction) if one is not None]


@pytest.mark.parametrize("wiring", BOARDS.values(), ids=BOARDS.keys())
def test_every_wire_has_a_pin_of_its_own(wiring: Wiring) -> None:
    pins = [wire.arduino for motor in wiring.motors for wire in wires(motor)]
    singles = (wiring.enable, wiring.led, wiring.estop, wiring.clutch)
    pins += [pin.arduino for pin in singles]
    assert len(set(pins)) == len(pins)
    assert not SERIAL_PINS & set(pins)
    bits = [(motor.direction.port, motor.direction.bit) for motor in wiring.motors]
    others = [(pin.port, pin.bit) for pin in singles]
    assert len({*bits, *others}) == 8


@pytest.mark.parametrize("wiring", BOARDS.values(), ids=BOARDS.keys())
def test_pwm_pins_are_those_of_the_timers(wiring: Wiring) -> None:
    used = [pwm for motor in wiring.motors for pwm in (motor.pwm, motor.second_pwm) if pwm is not None]
    assert {f"{pwm.arduino} {pwm.timer}{pwm.channel}" for pwm in used} == PWM_PINS[wiring.name]


def test_the_guide_shows_this_table() -> None:
    assert markdown_table() in (ROOT / "docs" / "your-arm.md").read_text(encoding="utf-8")


FIRST = MEGA.motors[0]


@pytest.mark.parametrize(
    ("name", "wired"),
    [
        ("power", (MEGA.estop, NANO.estop)),
        ("pwm-direction", (FIRST.pwm, FIRST.direction, MEGA.enable)),
        ("two-directions", (FIRST.pwm, FIRST.direction, FIRST.second_direction, MEGA.enable)),
        ("two-pwm", (FIRST.pwm, FIRST.second_pwm, MEGA.enable)),
    ],
)
def test_the_pictures_show_these_pins(name: str, wired: tuple[Pin | Pwm, ...]) -> None:
    """In the order in which they are drawn, from top to bottom."""
    picture = (ROOT / "docs" / "images" / f"wiring-{name}.svg").read_text(encoding="utf-8")
    assert re.findall(r"\bD\d+\b", picture) == [one.arduino for one in wired]


def test_the_guide_shows_the_other_drivers_pins() -> None:
    page = (ROOT / "docs" / "your-arm.md").read_text(encoding="utf-8")
    for number, motor in enumerate(BOARDS["mega"].motors):
        assert motor.second_pwm is not None
        assert motor.second_direction is not None
        both = f"{motor.pwm.arduino}, {motor.direction.arduino}, {motor.second_direction.arduino}"
        assert f"| {number} | {both} | {motor.pwm.arduino}, {motor.second_pwm.arduino} |" in page
