"""Writes the data of the bench inside a page: the arm's numbers, the mistakes, the motion of a person.

A mistake is done to a bench that only writes down what is done to it, so that it is described once, in
greywhale_sim.faults. sim/web/exports.cpp takes the numbers and the calls.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import PotentiometerBank
from greywhale.base.types import Floats
from greywhale.dashboard.answers import arm_facts
from greywhale.loop import human_reaches
from greywhale.protocol.firmware import JOINTS
from greywhale_sim import commands, faults

Call = list[str | float]

REACHES_HZ = 25  # a hand takes corners smoothly
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
        numbers += [one.stops.min, one.stops.max, pot.play, pot.lag]
    drive = arm.drive
    numbers += [drive.supply, drive.supply_resistance, drive.pwm_levels]
    return numbers + pot_numbers(arm.leader_pots) + pot_numbers(arm.follower_pots)


def pot_numbers(bank: PotentiometerBank) -> list[float]:
    """Four potentiometers and their supply, in the same order."""
    numbers: list[float] = []
    for pot in bank.joint:
        numbers += [pot.track, pot.centre, pot.direction, pot.noise, pot.linearity, pot.play, pot.lag]
    return [*numbers, bank.supply]


class _Recorder:
    """A bench to the functions of greywhale_sim.faults: it writes down what they do, as calls of the module."""

    board = None

    def __init__(self) -> None:
        self.calls: list[Call] = []
        self.pot_faults = self
        self.leader_pots, self.follower_pots = _Bank(self.calls, 0), _Bank(self.calls, JOINTS)

    def __getattr__(self, name: str) -> Callable[..., None]:
        return lambda *given: self.calls.append([name, *(_number(one) for one in given)])

    def __setattr__(self, name: str, value: Any) -> None:
        if name == "shared_supply":
            self.calls.append(["share_supply"])
        else:
            super().__setattr__(name, value)


def _number(given: Any) -> float:
    value: float = getattr(given, "value", given)  # a kind of fault is its number
    return int(value) if isinstance(value, bool) else value


class _Bank:
    def __init__(self, calls: list[Call], first: int) -> None:
        self._calls = calls
        self._first = first

    def set_wiring(self, joint: int, wiring: Any) -> None:
        self._calls.append(["set_wiring", self._first + joint, int(wiring.value)])


def fault_calls(name: str, place: str) -> list[Call]:
    """The calls that stage a mistake at a place; "" for the one that has none."""
    recorder: Any = _Recorder()
    fault = faults.BY_NAME[name]
    fault.inject(recorder, faults.WHERE[fault.on].index(place))
    calls: list[Call] = recorder.calls
    return calls


def bench_data(arm: ArmParameters) -> dict[str, Any]:
    """All of it, as the page reads it."""
    stops = [joint.stops for joint in arm.joint]
    return {
        "arm": arm_numbers(arm),
        "description": arm_facts(arm),
        "leader": {"minimum": [stop.min for stop in stops], "maximum": [stop.max for stop in stops]},
        "supply": {"minimum": 0.0, "maximum": commands.MOST_SUPPLY_V, "value": arm.drive.supply},
        "load": {"minimum": 0.0, "maximum": commands.MOST_LOAD_KG, "value": arm.tip.mass},
        "noise": {"minimum": 0.0, "maximum": MOST_TIMES, "value": 1.0},
        "play": {"minimum": 0.0, "maximum": MOST_TIMES, "value": 1.0},
        "faults": [
            {
                "name": one.name,
                "description": one.says,
                "places": {place: fault_calls(one.name, place) for place in faults.WHERE[one.on]},
            }
            for one in faults.FAULTS
        ],
        "reaches": {"hz": REACHES_HZ, "rows": reaches().tolist()},
    }


def reaches() -> Floats:
    """Poses of a person's motion (rows, 4) in rad, from when it begins to move."""
    motion = human_reaches()
    rows = np.round(motion.at(np.arange(0.0, motion.duration_s, 1.0 / REACHES_HZ)), 4)
    moved = np.abs(rows - rows[0]).max(axis=1) > BEGINS_RAD
    begun: Floats = rows[int(np.argmax(moved)) :]
    return begun
