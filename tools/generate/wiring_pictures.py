"""Draws the wiring diagrams docs/images/wiring-*.svg: `python -m tools.generate.wiring_pictures`.

Pins come from the bench's wiring tables, so the pictures show what the firmware uses; a test proves them current.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from greywhale_sim.wiring import MEGA, NANO
from tools import ROOT

IMAGES = ROOT / "docs" / "images"
POWER, LOGIC, SIGNAL, GROUND = "#c0392b", "#d68910", "#1f618d", "#222222"
STYLE = 'font-family="DejaVu Sans, Arial, sans-serif" font-size="14"'
DOT = 4.0
Point = tuple[float, float]


class Picture:
    """An SVG that grows element by element; coordinates in pixels, y down."""

    def __init__(self, width: float, height: float, title: str) -> None:
        self._size = (width, height)
        self._title = title
        self._parts: list[str] = []

    def box(self, x: float, y: float, width: float, height: float, text: str, fill: str = "#f4f6f7") -> None:
        """A part with its name in the middle, a line a row."""
        self._parts.append(
            f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="6" fill="{fill}" stroke="#555"/>'
        )
        rows = text.split("\n")
        for number, row in enumerate(rows):
            self.text(x + width / 2, y + height / 2 + 5 + 18 * (number - (len(rows) - 1) / 2), row, "middle")

    def text(self, x: float, y: float, text: str, anchor: str = "start", colour: str = "#111") -> None:
        self._parts.append(f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}" fill="{colour}">{escape(text)}</text>')

    def wire(self, points: Sequence[Point], colour: str, width: float = 2.0) -> None:
        path = " ".join(f"{x:g},{y:g}" for x, y in points)
        self._parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{width:g}"/>')

    def dot(self, x: float, y: float, colour: str) -> None:
        self._parts.append(f'<circle cx="{x:g}" cy="{y:g}" r="{DOT:g}" fill="{colour}"/>')

    def resistor(self, x: float, y: float, text: str, colour: str = SIGNAL) -> None:
        """An upright resistor, 40 high, its upper end here; the text on its right."""
        self._parts.append(
            f'<rect x="{x - 7:g}" y="{y:g}" width="14" height="40" fill="#fff" stroke="{colour}" stroke-width="2"/>'
        )
        self.text(x + 14, y + 25, text)

    def capacitor(self, x: float, y: float, text: str, colour: str = SIGNAL) -> None:
        """Two plates, 40 high with its leads, its upper end here."""
        self.wire([(x, y), (x, y + 16)], colour)
        self.wire([(x - 14, y + 16), (x + 14, y + 16)], colour, 3)
        self.wire([(x - 14, y + 24), (x + 14, y + 24)], colour, 3)
        self.wire([(x, y + 24), (x, y + 40)], colour)
        self.text(x + 20, y + 25, text)

    def ground(self, x: float, y: float) -> None:
        self.wire([(x, y), (x, y + 8)], GROUND)
        for number in range(3):
            half = 12 - 4 * number
            self.wire([(x - half, y + 8 + 5 * number), (x + half, y + 8 + 5 * number)], GROUND)

    def switch(self, x: float, y: float, colour: str) -> None:
        """A contact that opens, 50 wide, its left end here."""
        self.dot(x, y, colour)
        self.dot(x + 50, y, colour)
        self.wire([(x, y), (x + 48, y - 4)], colour, 3)

    def fuse(self, x: float, y: float, text: str) -> None:
        """50 wide, its left end here."""
        self._parts.append(
            f'<rect x="{x:g}" y="{y - 8:g}" width="50" height="16" fill="#fff" stroke="{POWER}" stroke-width="2"/>'
        )
        self.wire([(x, y), (x + 50, y)], POWER)
        self.text(x + 25, y - 14, text, "middle")

    def svg(self) -> str:
        width, height = self._size
        return "\n".join(
            [
                f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" width="{width:g}" '
                f'height="{height:g}" {STYLE}>',
                f"<title>{escape(self._title)}</title>",
                f'<rect width="{width:g}" height="{height:g}" fill="#ffffff"/>',
                *self._parts,
                "</svg>",
                "",
            ]
        )


def power() -> Picture:
    """From the supply to drivers and board, with fuses, switch and the emergency stop's second contact."""
    drawn = Picture(860, 400, "Supply, fuse, emergency stop, drivers and board, with one common ground")
    drawn.box(20, 50, 120, 70, "motors'\nsupply", "#fdedec")
    drawn.wire([(140, 70), (180, 70)], POWER, 3)
    drawn.fuse(180, 70, "main fuse")
    drawn.wire([(230, 70), (290, 70)], POWER, 3)
    drawn.switch(290, 70, POWER)
    drawn.text(315, 40, "emergency stop,", "middle")
    drawn.text(315, 56, "main contact", "middle")
    drawn.wire([(340, 70), (800, 70), (800, 130)], POWER, 3)
    for number in range(4):
        x = 400 + 105 * number
        drawn.wire([(x, 70), (x, 130)], POWER)
        drawn.dot(x, 70, POWER)
        drawn.box(x - 40, 130, 90, 60, f"driver {number}")
        drawn.wire([(x, 190), (x, 230)], GROUND)
        drawn.dot(x, 230, GROUND)
    drawn.capacitor(800, 130, "", POWER)
    drawn.text(780, 55, "1000 µF or more", "middle")
    drawn.wire([(800, 170), (800, 230)], GROUND)
    drawn.wire([(80, 120), (80, 230), (800, 230)], GROUND, 3)
    drawn.dot(80, 230, GROUND)
    drawn.text(100, 222, "one common ground")
    drawn.box(20, 290, 120, 70, "computer")
    drawn.wire([(140, 325), (240, 325)], GROUND)
    drawn.text(190, 317, "USB", "middle")
    drawn.box(240, 280, 150, 90, "Arduino\n(5 V by USB)")
    drawn.wire([(300, 280), (300, 230)], GROUND)
    drawn.dot(300, 230, GROUND)
    drawn.text(310, 262, "GND")
    drawn.wire([(390, 325), (480, 325)], SIGNAL)
    drawn.text(396, 317, f"{MEGA.estop.arduino}", "start", SIGNAL)
    drawn.switch(480, 325, SIGNAL)
    drawn.wire([(530, 325), (620, 325)], SIGNAL)
    drawn.ground(620, 325)
    drawn.text(400, 362, f"second contact of the same button (Nano: {NANO.estop.arduino})")
    drawn.text(400, 380, "opens when pressed: estop_input = 2")
    return drawn


def potentiometer() -> Picture:
    """One of eight, with the pull-down that makes an open wire read 0."""
    drawn = Picture(620, 300, "A potentiometer with its pull-down")
    drawn.text(60, 40, "5V of the board", "start", LOGIC)
    drawn.wire([(110, 50), (110, 90)], LOGIC)
    drawn.resistor(110, 90, "", GROUND)
    drawn.text(90, 112, "10 kΩ,", "end")
    drawn.text(90, 130, "linear", "end")
    drawn.wire([(110, 130), (110, 230)], GROUND)
    drawn.ground(110, 230)
    drawn.wire([(117, 110), (500, 110)], SIGNAL)
    drawn.wire([(117, 110), (130, 104), (130, 116), (117, 110)], SIGNAL)
    drawn.text(140, 102, "wiper: the middle terminal", "start", SIGNAL)
    drawn.dot(360, 110, SIGNAL)
    drawn.wire([(360, 110), (360, 150)], SIGNAL)
    drawn.resistor(360, 150, "100 kΩ")
    drawn.wire([(360, 190), (360, 230)], SIGNAL)
    drawn.ground(360, 230)
    drawn.dot(450, 110, SIGNAL)
    drawn.wire([(450, 110), (450, 150)], SIGNAL)
    drawn.capacitor(450, 150, "1 nF")
    drawn.wire([(450, 190), (450, 230)], SIGNAL)
    drawn.ground(450, 230)
    drawn.box(500, 70, 100, 80, "A0 ... A7")
    drawn.text(360, 285, "both close to the board's pin", "start")
    return drawn


def driver(title: str, signals: Sequence[tuple[str, str]], enable: str, note: str = "") -> Picture:
    """A driver beside the board: pins and the driver's names for them; a pull-down keeps its enable input low."""
    wires = [*signals, ("GND", "GND"), (MEGA.enable.arduino, enable)]
    last = 90 + 45 * (len(wires) - 1)
    drawn = Picture(800, last + (150 if note else 125), title)
    drawn.box(20, 60, 150, last, "Arduino\nMega 2560")
    drawn.box(440, 60, 150, last, "driver of\nmotor 0")
    for number, (pin, name) in enumerate(wires):
        y, colour = 90 + 45 * number, GROUND if pin == "GND" else SIGNAL
        drawn.wire([(170, y), (440, y)], colour)
        drawn.text(178, y - 6, pin, "start", colour)
        drawn.text(432, y - 6, name, "end", colour)
    drawn.dot(220, last, SIGNAL)
    drawn.wire([(220, last), (220, last + 50)], SIGNAL)
    drawn.resistor(220, last + 50, "10 kΩ, once for all drivers")
    drawn.ground(220, last + 90)
    drawn.dot(300, last, SIGNAL)
    drawn.wire([(300, last), (300, last + 35)], SIGNAL)
    drawn.text(308, last + 28, "other drivers", "start", SIGNAL)
    drawn.box(680, 110, 90, 90, "motor 0", "#eafaf1")
    drawn.wire([(590, 130), (680, 130)], POWER, 3)
    drawn.wire([(590, 180), (680, 180)], POWER, 3)
    drawn.text(510, 30, "supply, behind fuse and emergency stop", "middle", POWER)
    drawn.wire([(510, 36), (510, 60)], POWER, 3)
    drawn.text(20, last + 138, note)
    return drawn


def drivers() -> dict[str, Picture]:
    """One picture for each kind of driver, by the end of its file's name."""
    motor = MEGA.motors[0]
    assert motor.second_direction is not None
    assert motor.second_pwm is not None
    pwm, direction = motor.pwm.arduino, motor.direction.arduino
    no_enable = "A driver without an enable input needs no such wire."
    two_pwm = "nSLEEP of a DRV8833; R_EN and L_EN of a BTS7960. A DRV8871 has no such input."
    return {
        "pwm-direction": driver(
            "A driver with PWM and direction: driver = 0",
            ((pwm, "PWM"), (direction, "DIR (PHASE)")),
            "EN (nSLEEP)",
            no_enable,
        ),
        "two-directions": driver(
            "A driver with PWM, IN1 and IN2: driver = 1",
            ((pwm, "PWM (ENA)"), (direction, "IN1"), (motor.second_direction.arduino, "IN2")),
            "STBY",
            "An L298N has no such input.",
        ),
        "two-pwm": driver(
            "A driver with two PWM inputs: driver = 2 or 3",
            ((pwm, "IN1 (RPWM)"), (motor.second_pwm.arduino, "IN2 (LPWM)")),
            "enable",
            two_pwm,
        ),
    }


PICTURES = {
    f"wiring-{name}.svg": picture
    for name, picture in {"power": power(), "potentiometer": potentiometer(), **drivers()}.items()
}


def main() -> None:
    for name, picture in PICTURES.items():
        (IMAGES / name).write_text(picture.svg(), encoding="utf-8")


if __name__ == "__main__":
    main()
