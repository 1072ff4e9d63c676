"""The wires of the arm and their pins on the board: one table per board, as in README.md.

Leader potentiometers are on A0..A3 and follower potentiometers on A4..A7 of both boards.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from greywhale import _native

BOOTLOADERS = Path(__file__).resolve().parent / "bootloaders"  # their source is in sim/bootloaders


@dataclass(frozen=True)
class Pin:
    """A digital pin: the Arduino's number and the chip's port and bit."""

    arduino: str
    port: str
    bit: int

    @property
    def native(self) -> tuple[str, int]:
        return self.port, self.bit


@dataclass(frozen=True)
class Pwm:
    """A pin with PWM: compare output `channel` of `timer`."""

    arduino: str
    timer: int
    channel: str

    @property
    def native(self) -> tuple[int, str]:
        return self.timer, self.channel


@dataclass(frozen=True)
class Motor:
    """The wires of one motor driver: PWM and direction, and where the board has the pins a second one of each."""

    pwm: Pwm
    direction: Pin
    second_pwm: Pwm | None = None
    second_direction: Pin | None = None


@dataclass(frozen=True)
class Wiring:
    """One board and what is connected to it."""

    name: str
    title: str
    mcu: str
    environment: str  # PlatformIO's
    bootloader: Path
    bootloader_baud: int
    motors: tuple[Motor, Motor, Motor, Motor]
    enable: Pin  # the drivers' enable inputs, high = motors powered; an external pull-down keeps them off at reset
    led: Pin
    estop: Pin  # a button to ground, optional; the pin has a pull-up
    clutch: Pin  # a pedal to ground, optional; the pin has a pull-up

    def native(self) -> _native.BenchWiring:
        """These pins for the bench in C++."""
        second = [
            (motor.second_pwm.native, motor.second_direction.native)
            for motor in self.motors
            if motor.second_pwm and motor.second_direction
        ]
        return _native.BenchWiring(
            enable=self.enable.native,
            motors=[(motor.pwm.native, motor.direction.native) for motor in self.motors],
            second=second or None,
            estop=self.estop.native,
            clutch=self.clutch.native,
        )


MEGA = Wiring(
    name="mega",
    title="Arduino Mega 2560",
    mcu="atmega2560",
    environment="megaatmega2560",
    bootloader=BOOTLOADERS / "mega.hex",
    bootloader_baud=115200,
    motors=(
        Motor(Pwm("D5", 3, "A"), Pin("D22", "A", 0), Pwm("D2", 3, "B"), Pin("D23", "A", 1)),
        Motor(Pwm("D6", 4, "A"), Pin("D24", "A", 2), Pwm("D46", 5, "A"), Pin("D25", "A", 3)),
        Motor(Pwm("D7", 4, "B"), Pin("D26", "A", 4), Pwm("D45", 5, "B"), Pin("D27", "A", 5)),
        Motor(Pwm("D8", 4, "C"), Pin("D28", "A", 6), Pwm("D44", 5, "C"), Pin("D29", "A", 7)),
    ),
    enable=Pin("D9", "H", 6),
    led=Pin("D13", "B", 7),
    estop=Pin("D10", "B", 4),
    clutch=Pin("D11", "B", 5),
)

NANO = Wiring(
    name="nano",
    title="Arduino Nano (ATmega328P)",
    mcu="atmega328p",
    environment="nanoatmega328",
    # The older of the Nano's two bootloaders: the newer one (optiboot), as Debian builds it, is too large for the chip.
    bootloader=BOOTLOADERS / "nano.hex",
    bootloader_baud=57600,
    motors=(
        Motor(Pwm("D9", 1, "A"), Pin("D2", "D", 2)),
        Motor(Pwm("D10", 1, "B"), Pin("D4", "D", 4)),
        Motor(Pwm("D11", 2, "A"), Pin("D7", "D", 7)),
        Motor(Pwm("D3", 2, "B"), Pin("D8", "B", 0)),
    ),
    enable=Pin("D12", "B", 4),
    led=Pin("D13", "B", 5),
    estop=Pin("D5", "D", 5),
    clutch=Pin("D6", "D", 6),
)

BOARDS: Mapping[str, Wiring] = {wiring.name: wiring for wiring in (MEGA, NANO)}


def markdown_table() -> str:
    """The wiring of every board, as docs/your-arm.md shows it."""
    boards = tuple(BOARDS.values())
    joints = ("base yaw", "shoulder pitch", "wrist pitch", "wrist roll")
    rows = [["wire", *(board.title for board in boards)], ["---"] * (len(boards) + 1)]
    for side, first in (("leader", 0), ("follower", 4)):
        pins = ", ".join(f"A{first + joint}" for joint in range(4))
        rows.append([f"{side} potentiometers, joints 0 to 3", *([pins] * len(boards))])
    for joint, name in enumerate(joints):
        rows.append([f"motor {joint} ({name}), PWM", *(board.motors[joint].pwm.arduino for board in boards)])
        rows.append([f"motor {joint}, direction", *(board.motors[joint].direction.arduino for board in boards)])
    rows.append(["enable of all drivers", *(board.enable.arduino for board in boards)])
    rows.append(["emergency stop, a button to ground (optional)", *(board.estop.arduino for board in boards)])
    rows.append(["clutch, a pedal to ground (optional)", *(board.clutch.arduino for board in boards)])
    rows.append(["state LED (on the board)", *(board.led.arduino for board in boards)])
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)
