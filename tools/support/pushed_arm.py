"""Recordings of an arm that somebody pushes: the plant may be greywhale's own or MuJoCo's, the log is all that is told.

The firmware's work is written out here: four conversions a tick, its filter, its scale, its own law.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
import numpy.typing as npt

from greywhale.arm import Arm, ArmParameters, Potentiometers
from greywhale.base.types import Floats
from greywhale.files.log import Log, LogWriter, read_log
from greywhale.files.log.layout import Origin
from greywhale.files.trajectory import Trajectory
from greywhale.fuzzy.settings import JointSettings
from greywhale.observe import Contact, ExternalTorque
from greywhale.protocol.firmware import ANGLE_LSB, JOINTS
from greywhale.protocol.table import ParameterTable

SLICE_S, SLICES = 0.25e-3, 4
SETTLING_S = 1.5  # before the log begins
EVERY_S, LASTS_S = 1.6, 0.6  # a push begins, and so long it lasts
LATE_S = 0.065  # after which an estimate shows all of a push
SHAKES_S = 0.15


class PushedPlant(Protocol):
    """An arm: four volts and seconds in, the angles (rad) that its potentiometers stand at out."""

    def push(self, torques: Floats) -> None:
        """Push on its joints, N m, from now on."""

    def step(self, voltages: Floats, dt: float) -> Floats: ...


class OwnPlant:
    """Greywhale's own arm; its potentiometers have their play and lag themselves."""

    def __init__(self, arm: ArmParameters, start: Floats, seed: int) -> None:
        self._arm = Arm(arm, seed)
        self._arm.reset(start)

    def push(self, torques: Floats) -> None:
        self._arm.set_load(torques)

    def step(self, voltages: Floats, dt: float) -> Floats:
        return self._arm.step(voltages, dt)


@dataclass(frozen=True)
class Push:
    """A torque (N m) on a joint from `begin` to `end` (s of the log)."""

    joint: int
    torque: float
    begin: float
    end: float


def some_pushes(arm: ArmParameters, seconds: float, shares: tuple[float, float], seed: int) -> list[Push]:
    """Pushes on one joint after the other, by a share of its stall torque between these, either way."""
    random = np.random.default_rng(900 + seed)
    pushes = []
    for number, begin in enumerate(np.arange(1.0, seconds - EVERY_S, EVERY_S)):
        joint = number % JOINTS
        stall = arm.actuator(joint).torque_per_volt * arm.drive.supply
        torque = float(random.uniform(*shares) * random.choice([-1.0, 1.0])) * stall
        start = float(begin + random.uniform(0.0, 0.5))
        pushes.append(Push(joint, torque, start, start + LASTS_S))
    return pushes


def torques_of(pushes: list[Push], time: Floats) -> Floats:
    """The torques (n, 4) N m of pushes at times (n,) s."""
    torques = np.zeros((len(time), JOINTS))
    for one in pushes:
        torques[(time >= one.begin) & (time < one.end), one.joint] += one.torque
    return torques


def record_pushed(
    plant: PushedPlant,
    arm: ArmParameters,
    motion: Trajectory,
    path: Path,
    table: ParameterTable,
    pushes: list[Push],
    seed: int = 1,
) -> Log:
    """Record `motion` (rad) on a plant whose potentiometers are those of `arm`, pushed, as the log `path`."""
    before = round(SETTLING_S * 1000)
    ticks = int(motion.time_s[-1] * 1000)
    leader = np.column_stack([np.interp(np.arange(ticks) / 1000, motion.time_s, angles) for angles in motion.angles.T])
    leader = np.round(np.vstack([np.tile(leader[:1], (before, 1)), leader]) / ANGLE_LSB).astype(np.int16)
    torques = torques_of(pushes, np.arange(-before, ticks) / 1000)
    pots = Potentiometers(arm.follower_pots, seed + 1)
    laws = [JointSettings(*row).controller(table.period_ms) for row in table.controllers]
    share, supply = 1.0 / (1 << table["filter_shift"]), np.array([table["supply_mv"]], dtype=np.uint16)
    zero, scale = np.array(table.each("follower", "zero")), np.array(table.each("follower", "scale"))
    volts, next_volts = np.zeros(JOINTS), np.zeros(JOINTS)
    counts, filtered = np.zeros((SLICES, JOINTS)), None
    with LogWriter(path, Origin("0.1.0", table.board.key, table.crc, table.period_ms, 1)) as log:
        for tick, target in enumerate(leader):
            plant.push(torques[tick])
            for slice_ in range(SLICES):
                angles = plant.step(volts if slice_ == 0 else next_volts, SLICE_S)
                millivolts = pots.millivolts(angles)
                counts[slice_] = np.minimum(np.floor(millivolts / (1000.0 * arm.follower_pots.supply) * 1024.0), 1023.0)
            total = counts.sum(axis=0) * 4.0
            filtered = total if filtered is None else filtered + (total - filtered) * share
            reading = np.floor((filtered - zero) * scale / 8192.0 + 0.5).astype(np.int16)
            volts = next_volts.copy()
            for joint, law in enumerate(laws):
                out = law.run(target[joint : joint + 1], reading[joint : joint + 1], supply)
                next_volts[joint] = out["volts_mv"][0] / 1000.0
            if tick >= before:
                row = (target * ANGLE_LSB, reading * ANGLE_LSB, next_volts.tolist())
                log.append((tick - before) / 1000, *row, "following")
    return read_log(path)


@dataclass(frozen=True)
class Judged:
    """Of the told rows whose push has lasted as long as the filters: errors and half widths as shares of the stall
    torque, and whether intervals hold, by joint; s until each push was seen as a contact (NaN: never); other contacts.
    """

    error: tuple[Floats, ...]
    half_width: tuple[Floats, ...]
    held: tuple[npt.NDArray[np.bool_], ...]
    seen: Floats
    false: tuple[Contact, ...]


def judge(found: ExternalTorque, log: Log, arm: ArmParameters, pushes: list[Push]) -> Judged:
    """Compare what was found in a log with the pushes that acted."""
    true = torques_of(pushes, log.time)
    steady = (torques_of(pushes, log.time - LATE_S) == true) & found.told
    stall = np.array([arm.actuator(joint).torque_per_volt * arm.drive.supply for joint in range(JOINTS)])
    error, half = (found.torque - true) / stall, found.half_width / stall
    rows = [steady[:, joint] for joint in range(JOINTS)]
    first = [
        next((one.time for one in found.contacts if one.joint == push.joint and _during(one, push)), np.nan)
        for push in pushes
    ]
    return Judged(
        tuple(error[row, joint] for joint, row in enumerate(rows)),
        tuple(half[row, joint] for joint, row in enumerate(rows)),
        tuple((np.abs(error) <= half)[row, joint] for joint, row in enumerate(rows)),
        np.array(first) - np.array([push.begin for push in pushes]),
        tuple(one for one in found.contacts if not any(_during(one, push) for push in pushes)),
    )


def _during(contact: Contact, push: Push) -> bool:
    """True for a contact while somebody pushes, or just after: the arm shakes then, other joints too."""
    return push.begin <= contact.time <= push.end + SHAKES_S
