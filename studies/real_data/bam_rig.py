"""Recordings of Rhoban's BAM (better actuator models): a servo motor that swings a weight under its own controller.

The motor's duty is (goal - angle) times a gain, within its limits: known, so that a model can be judged in the closed
loop, from the goals alone, as BAM judges its own. Errors are mean absolute ones, in mrad, BAM's measure.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greywhale._native import Arm
from greywhale.arm import ArmParameters
from greywhale.base.errors import FAILED, UserError
from greywhale.base.types import Floats
from greywhale.files.exchange.bam import FULL_PWM
from greywhale.files.exchange.sources import open_source
from greywhale.files.log import Log
from studies.real_data.rigs import SERVO_RIG

# BAM's bam/dynamixel/actuator.py: a step of the encoder costs 1/256 of the gain.
COUNTS_A_RAD = 4096 / (2 * math.pi)
GAIN_OF_KP = COUNTS_A_RAD / (256 * FULL_PWM)
CONTROL_S = 1e-3  # the servo's own period is not published
JOINT = SERVO_RIG.joint
HANGING = -math.pi / 2  # a pitch is level at 0
COLUMNS = ("timestamp", "goal_position", "position", "volts", "input_volts", "torque_enable")


@dataclass(frozen=True)
class Swing:
    """A recording up to where the motor is released: seconds, rad, and the duty within -1..1, of which 1 is full."""

    name: str
    motion: str
    kp: int
    supply: float  # V, as its head tells
    mass: float
    length: float
    time: Floats
    goal: Floats
    angle: Floats
    duty: Floats

    @property
    def gain(self) -> float:
        """Duty per rad."""
        return self.kp * GAIN_OF_KP

    def log(self) -> Log:
        return SERVO_RIG.log(self.name, self.time, self.goal, self.angle, self.duty * SERVO_RIG.supply)

    def at(self, times: Floats) -> tuple[Floats, Floats]:
        """Goals and angles between the samples."""
        return np.interp(times, self.time, self.goal), np.interp(times, self.time, self.angle)


def read_folder(folder: Path) -> tuple[list[Swing], dict[str, dict[str, Any]]]:
    """All recordings of the rig's motor below a folder, and BAM's parameter files there by their path.

    Both are JSON and told apart by what they hold; other files are passed over. UserError where no recording is there.
    """
    swings, models = [], {}
    for path in sorted(folder.rglob("*.json")):
        data = json.loads(path.read_text(encoding="utf-8"))
        if data.get("motor") == "xl330" and "dt" not in data:  # with dt it is interpolated, across wrapped signs too
            swings.append(_swing(path, data))
        elif "kt" in data and data.get("actuator") == "xl330":
            models[path.relative_to(folder).with_suffix("").as_posix()] = data
    if not swings:
        raise UserError(
            f"{folder} holds no raw recording of an XL330 by BAM; docs/real_data.md says where they are.", FAILED
        )
    return swings, models


def _swing(path: Path, head: dict[str, Any]) -> Swing:
    columns = open_source(path, "bam", JOINT).load(COLUMNS, ())
    on: NDArray[np.bool_] = np.cumprod(columns["torque_enable"] > 0).astype(bool)
    time, goal, angle, volts, supply, _ = (columns[name][on] for name in COLUMNS)
    motion, kp = head["trajectory"], int(head["kp"])
    name = f"kp{kp}_{motion}"
    return Swing(name, motion, kp, head["vin"], head["mass"], head["length"], time, goal, angle, volts / supply)


def closed_loop(arm: ArmParameters, zero: float, swing: Swing) -> float:
    """Our model's mean absolute error in mrad, from the goals alone; the encoder reads 0 at the angle `zero`, rad."""
    plant = Arm(arm.native())
    times = np.arange(swing.time[0], swing.time[-1], CONTROL_S)
    goals, measured = swing.at(times)
    turn = HANGING + zero
    angles, volts = np.zeros(4), np.zeros(4)
    angles[JOINT] = measured[0] + turn
    plant.reset(angles)
    found = np.empty(len(times))
    for row, goal in enumerate(goals.tolist()):
        found[row] = angles[JOINT] - turn
        volts[JOINT] = swing.supply * min(max(swing.gain * (goal - found[row]), -1.0), 1.0)
        plant.step(volts, CONTROL_S, angles)
    return 1e3 * float(np.mean(np.abs(found - measured)))


def mean_error(arm: ArmParameters, zero: float, swings: Sequence[Swing]) -> float:
    return float(np.mean([closed_loop(arm, zero, one) for one in swings]))


def of_motions(swings: Iterable[Swing], motions: Sequence[str], kps: Sequence[int]) -> list[Swing]:
    return [one for one in swings if one.motion in motions and one.kp in kps]
