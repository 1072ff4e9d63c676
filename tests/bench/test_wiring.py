"""The wiring tables: no pin twice, the same in docs/your-arm.md."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

from greywhale_sim.wiring import BOARDS, Motor, Pin, Pwm, Wiring, markdown_table
from tools import ROOT
from tools.generate.wiring_pictures import IMAGES, PICTURES

# Which compare output is on which Arduino pin, from the boards' own pin tables.
PWM_PINS = {
    "mega": {
        "D5": (3, "A"),
        "D6": (4, "A"),
        "D7": (4, "B"),
        "D8": (4, "C"),
        "D2": (3, "B"),
        "D46": (5, "A"),
        "D45": (5, "B"),
        "D44": (5, "C"),
    },
    "nano": {"D9": (1, "A"), "D10": (1, "B"), "D11": (2, "A"), "D3": (2, "B")},
}
SERIAL_PINS = {"D0", "D1"}
SVG = "{http://www.w3.org/2000/svg}"


def wires(motor: Motor) -> list[Pin | Pwm]:
    return [one for one in (motor.pwm, motor.direction, motor.second_pwm, motor.second_direction) if one is not None]


@pytest.mark.parametrize("wiring", BOARDS.values(), ids=BOARDS.keys())
def test_every_wire_has_a_pin_of_its_own(wiring: Wiring) -> None:
    pins = [wire.arduino for motor in wiring.motors for wire in wires(motor)]
    pins += [wiring.enable.arduino, wiring.led.arduino, wiring.estop.arduino]
    assert len(set(pins)) == len(pins)
    assert not SERIAL_PINS & set(pins)
    bits = [(motor.direction.port, motor.direction.bit) for motor in wiring.motors]
    others = [(pin.port, pin.bit) for pin in (wiring.enable, wiring.led, wiring.estop)]
    assert len({*bits, *others}) == 7


@pytest.mark.parametrize("wiring", BOARDS.values(), ids=BOARDS.keys())
def test_pwm_pins_are_those_of_the_timers(wiring: Wiring) -> None:
    used = [pwm for motor in wiring.motors for pwm in (motor.pwm, motor.second_pwm) if pwm is not None]
    assert {pwm.arduino: (pwm.timer, pwm.channel) for pwm in used} == PWM_PINS[wiring.name]


def test_the_guide_shows_this_table() -> None:
    assert markdown_table() in (ROOT / "docs" / "your-arm.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", PICTURES)
def test_the_pictures_show_these_pins(name: str) -> None:
    """If not: `python -m tools.generate.wiring_pictures`."""
    assert (IMAGES / name).read_text(encoding="utf-8") == PICTURES[name]().svg()


@pytest.mark.parametrize("name", PICTURES)
def test_no_word_in_the_pictures_is_cut_off_or_over_another(name: str) -> None:
    svg = ElementTree.fromstring(PICTURES[name]().svg())
    wide, high = (float(svg.attrib[side]) for side in ("width", "height"))
    boxes = [(one.text or "", box_of(one)) for one in svg.iter(f"{SVG}text") if one.text]
    assert len(boxes) >= 5
    for place, (words, (left, top, right, bottom)) in enumerate(boxes):
        assert 4 <= left < right <= wide - 4, words
        assert 2 <= top < bottom <= high - 2, words
        for other, (x0, y0, x1, y1) in boxes[place + 1 :]:
            assert right <= x0 or x1 <= left or bottom <= y0 or y1 <= top, f"{words} is over {other}"


def box_of(text: ElementTree.Element) -> tuple[float, float, float, float]:
    """Left, top, right and bottom of words in the font that the pictures ask for first, pixels."""
    x, y = float(text.attrib["x"]), float(text.attrib["y"])
    ink = TextPath((0.0, 0.0), text.text or "", size=14, prop=FontProperties(family="DejaVu Sans")).get_extents()
    start = x - {"start": 0.0, "middle": 0.5, "end": 1.0}[text.attrib["text-anchor"]] * ink.width
    return start, y - ink.y1, start + ink.width, y - ink.y0


def test_the_guide_shows_the_other_drivers_pins() -> None:
    page = (ROOT / "docs" / "your-arm.md").read_text(encoding="utf-8")
    for number, motor in enumerate(BOARDS["mega"].motors):
        assert motor.second_pwm is not None
        assert motor.second_direction is not None
        both = f"{motor.pwm.arduino}, {motor.direction.arduino}, {motor.second_direction.arduino}"
        assert f"| {number} | {both} | {motor.pwm.arduino}, {motor.second_pwm.arduino} |" in page
