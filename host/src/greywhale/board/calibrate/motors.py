"""Short weak pulses of one motor at a time: which joint moves, and which way, before anything follows.

The firmware itself limits a pulse. A set of parameters that is never stored gives this joint's controller so many volts
at most (`ku_mv`, with neither integral part nor damping) and the others none; the lease ends it after LEASE_MS; and
`tracking_limit` makes it a fault when the joint is farther than two steps of a pulse from where it is told to be.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.board.calibrate.rules import ask, words
from greywhale.board.device import Device, RestartedError
from greywhale.board.stream import stream
from greywhale.board.upload import run_set
from greywhale.protocol import schema
from greywhale.protocol.firmware import ANGLE_LSB, JOINTS, STEP_LSB
from greywhale.protocol.table import ParameterTable

_LIMITS = ask("pulse", 0, 0.0)[0].tolist()
LEASE_MS, SETTLE_TICKS, STILL_TICKS, PATIENCE_TICKS = (int(limit) for limit in _LIMITS[:4])
PULSE_STEP_RAD, STILL_RAD = _LIMITS[4:]


@dataclass(frozen=True)
class Motor:
    """A motor that turned: `sign` 1 as its parameter says, -1 the other way, and the voltage that did it.

    `way` (rad) is half of what lies between a pulse one way and one the other, so gravity has no part in it.
    """

    joint: int
    sign: int
    volts: float
    way: float


def examine_motor(
    device: Device, table: ParameterTable, joint: int, report: Callable[[float], None] = lambda volts: None
) -> Motor:
    """Try a motor with ever more voltage; `report` is told each. `table` is what the board shall run otherwise, with
    the potentiometers calibrated; the pulses' own set runs afterwards. Raises UserError where no joint moves, or
    another one.
    """
    told, pulses = 0.0, list[Floats]()
    while True:
        answer, mistake = ask("motor", joint, table.supply_v, pulses)
        if mistake:
            raise UserError(f"{device.port}: {mistake}")
        if len(answer) == 3:
            sign, volts, moved = answer.tolist()
            return Motor(joint, int(sign), volts, moved)
        volts, way = answer.tolist()
        if volts != told:
            report(volts)
        told = volts
        try:
            pulses.append(pulse(device, pulse_table(table, joint, volts), joint, int(way)))
        except RestartedError as error:
            raise UserError(
                f"{device.port}: the board restarted while the motor of joint {joint} was driven with {volts:.1f} V "
                f"({error.cause}): its supply sinks when a motor draws. Give the motors a supply of their own, with a "
                "common ground, and 1000 uF or more at the drivers, and begin anew."
            ) from None


def remarks(motors: Sequence[Motor], supply_v: float) -> tuple[str, ...]:
    """Sentences about motors that moved their joints, but with more voltage than one expects."""
    return tuple(words("remarks", supply_v, [(one.joint, one.volts, one.way) for one in motors]).splitlines())


def pulse_table(table: ParameterTable, joint: int, volts: float) -> ParameterTable:
    """The set with which a pulse runs; it is for this joint only, and never stored."""
    lines = (line.split() for line in words("pulse", joint, volts).splitlines())
    return table.with_raw({name: schema.PARAMETER_BY_NAME[name].to_raw(float(value)) for name, value in lines})


def pulse(device: Device, weak: ParameterTable, joint: int, way: int) -> Floats:
    """The way (4,) rad of a pulse, `way` 1 or -1, with the set of `pulse_table`; the motors are off afterwards."""
    run_set(device, weak)
    _wait_until_still(device)
    step = [0, 0, 0, 0]
    step[joint] = way * round(PULSE_STEP_RAD / STEP_LSB)
    device.telemetry(1)
    samples: list[schema.Sample] = []
    try:
        begun = device.lead(LEASE_MS)
        device.lead_point(begun.next, (step[0], step[1], step[2], step[3]))
        while not samples or samples[-1].tick - samples[0].tick < LEASE_MS + SETTLE_TICKS:
            samples += device.samples()
    finally:
        device.stop()
        device.telemetry(0)
    if device.status().state is schema.State.FAULT:
        # Cleared where any distance from the leader will do: nobody holds the arm.
        run_set(device, weak.with_raw({"tracking_limit": 0}))
        device.ask(schema.ClearFaultRequest())
    angles = np.array([one.follower for one in samples], dtype=np.float64) * ANGLE_LSB
    away = angles - np.array(begun.reference) * ANGLE_LSB
    most = np.argmax(np.abs(away), axis=0)
    moved: Floats = away[most, np.arange(JOINTS)]
    return moved


def _wait_until_still(device: Device) -> None:
    """Until the follower has rested for a while; it may have been falling since the last pulse."""
    angles: deque[tuple[int, ...]] = deque(maxlen=STILL_TICKS)
    try:
        for one in stream(device, 1):
            angles.append(one.sample.follower)
            if len(angles) == STILL_TICKS and _is_still(angles[0], angles[-1]) and _is_still(*angles):
                return
            if one.elapsed > PATIENCE_TICKS:
                raise UserError(f"{device.port}: the follower does not come to rest; lay it down, and begin anew.")
    finally:
        device.telemetry(0)


def _is_still(*angles: tuple[int, ...]) -> bool:
    """True if no joint moves between these raw angles (4,) of the follower."""
    return all(max(joint) - min(joint) <= STILL_RAD / ANGLE_LSB for joint in zip(*angles, strict=True))
