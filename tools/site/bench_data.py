"""Writes the data of the bench inside a page: the numbers of board and arm, the mistakes, the motion of a person.

sim/web/exports.cpp takes the numbers and the calls.
"""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import PotentiometerBank
from greywhale.base.types import Floats
from greywhale.board.flash.images import read_pieces
from greywhale.dashboard.answers import arm_facts
from greywhale.files.trajectory import Trajectory
from greywhale_sim import commands, faults
from greywhale_sim.motions import MOTIONS
from greywhale_sim.wiring import MEGA, Pin, Wiring

Call = list[str | float]

MOTION_HZ = 25  # a hand takes corners smoothly
BEGINS_RAD = 0.02
MOST_TIMES = 10.0  # of the arm's own noise and play


def arm_numbers(arm: ArmParameters) -> list[float]:
    """An arm whose joints are all in use, in the order of the Reader in sim/web/exports.cpp."""
    numbers: list[float] = []
    for link in arm.link:
        inertia = link.inertia
        numbers += [link.mass, link.length, link.centre, inertia.xx, inertia.yy, inertia.zz]
    numbers += [arm.tip.mass, arm.gravity]
    for joint, pot in enumerate(arm.follower_pots.joint):
        actuator, one = arm.actuator(joint), arm.joint[joint]
        numbers += [actuator.torque_per_volt, actuator.inertia, actuator.damping, actuator.resistance]
        friction, gear = one.friction, one.gear
        numbers += [friction.coulomb, friction.breakaway, friction.stribeck_velocity, friction.load]
        numbers += [friction.creep_velocity, gear.half_gap, gear.stiffness, gear.damping, gear.drag]
        numbers += [one.stops.min, one.stops.max, pot.play, pot.lag, one.driver.lost_up, one.driver.lost_down]
    drive = arm.drive
    numbers += [drive.supply, drive.supply_resistance, drive.pwm_levels]
    return numbers + pot_numbers(arm.leader_pots) + pot_numbers(arm.follower_pots)


def pot_numbers(bank: PotentiometerBank) -> list[float]:
    """Four potentiometers and their supply, in the same order."""
    numbers: list[float] = []
    for pot in bank.joint:
        numbers += [pot.track, pot.centre, pot.direction, pot.noise, pot.linearity, pot.play, pot.lag]
    return [*numbers, bank.supply]


def wiring_numbers(wiring: Wiring) -> list[float]:
    """The pins of a board, in the same order."""
    numbers: list[float] = [*_pin(wiring.enable)]
    for motor in wiring.motors:
        numbers += [motor.pwm.timer, ord(motor.pwm.channel), *_pin(motor.direction)]
    return [*numbers, *_pin(wiring.estop), *_pin(wiring.clutch)]


def _pin(pin: Pin) -> tuple[int, int]:
    return ord(pin.port), pin.bit


def program(path: Path) -> dict[str, Any]:
    """The one piece of a HEX file, which lies beside the firmware that a page reads itself."""
    ((address, content),) = read_pieces(path)
    return {"address": address, "bytes": base64.b64encode(content).decode("ascii")}


def fault_calls(name: str, place: str) -> list[Call]:
    """The calls that stage a mistake at a place; "" for the one that has none."""
    fault = faults.BY_NAME[name]
    calls = fault.calls(faults.WHERE[fault.on].index(place))
    return [[str(method), *map(_number, given)] for method, *given in calls]


def _number(given: Any) -> float:
    value: float = getattr(given, "value", given)  # a kind of fault is its number
    return int(value) if isinstance(value, bool) else value


def bench_data(arm: ArmParameters, wiring: Wiring = MEGA) -> dict[str, Any]:
    """All of it, as the page reads it."""
    stops = [joint.stops for joint in arm.joint]
    return {
        "bootloader": program(wiring.bootloader),
        "numbers": wiring_numbers(wiring) + arm_numbers(arm),
        "description": arm_facts(arm),
        "leader": {"minimum": [stop.min for stop in stops], "maximum": [stop.max for stop in stops]},
        "supply": {"minimum": 0.0, "maximum": commands.MOST_SUPPLY_V, "value": arm.drive.supply},
        "load": {"minimum": 0.0, "maximum": commands.MOST_LOAD_KG, "value": arm.tip.mass},
        "noise": {"minimum": 0.0, "maximum": MOST_TIMES, "value": 1.0},
        "play": {"minimum": 0.0, "maximum": MOST_TIMES, "value": 1.0},
        "faults": [
            {
                **faults.facts(one),
                "places": {place: fault_calls(one.name, place) for place in faults.WHERE[one.on]},
            }
            for one in faults.FAULTS
        ],
        "motions": [
            {"name": name, "title": motion.title, "hz": MOTION_HZ, "rows": rows_of(motion.make()).tolist()}
            for name, motion in MOTIONS.items()
        ],
    }


def rows_of(motion: Trajectory) -> Floats:
    """Poses of a person's motion (rows, 4) in rad, from when it begins to move."""
    rows = np.round(motion.at(np.arange(0.0, motion.duration_s, 1.0 / MOTION_HZ)), 4)
    moved = np.abs(rows - rows[0]).max(axis=1) > BEGINS_RAD
    begun: Floats = rows[int(np.argmax(moved)) :]
    return begun
