"""The three rigs: what their authors publish, and their recordings as greywhale's own logs.

Nothing here was found out from the recordings. Each rig has one joint, so one joint of the log and of the arm moves.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.errors import FAILED, UserError, os_reason
from greywhale.base.types import Floats
from greywhale.files.exchange.bam import FULL_PWM
from greywhale.files.log import Log
from greywhale.files.log.layout import Origin
from greywhale.protocol.firmware import JOINTS

GRAVITY = 9.80665
STOP_RAD = 2 * math.pi  # no stop is known
DUST_KG = 1e-6  # of links that a rig does not have


@dataclass(frozen=True)
class Rig:
    """What is published of a rig. alpha, inertia and damping: volts per N m, rad/s² and rad/s.

    Where gravity does not act, volts and torques cannot be told apart: alpha is 1 then.
    """

    name: str
    supply: float  # V
    inertia: float
    damping: float
    alpha: float = 1.0
    weight_kg: float = 0.0  # at the end of the link
    length_m: float = 0.0

    @property
    def joint(self) -> int:
        """A joint that swings a weight is a shoulder; one that feels none a base yaw."""
        return 1 if self.weight_kg else 0

    def arm(self) -> ArmParameters:
        """An arm file's content: N = 1, Bm = 0, and Kt, R, J by the white box's combinations."""
        motor = {
            "inertia": self.inertia / self.alpha,
            "resistance": self.alpha * self.damping,
            "torque_constant": self.damping,
            "viscous": 0.0,
            "gear_ratio": 1.0,
        }
        dust = {"mass": DUST_KG, "length": 0.01, "centre": 0.005, "inertia": {"xx": 1e-10, "yy": 1e-10, "zz": 1e-10}}
        links = [dict(dust) for _ in range(JOINTS)]
        if self.weight_kg:
            links[1] |= {"mass": self.weight_kg, "length": self.length_m, "centre": self.length_m}
        joint = {"motor": motor, "stops": {"min": -STOP_RAD, "max": STOP_RAD}}
        content = {
            "name": self.name,
            "gravity": GRAVITY,
            "link": tuple(links),
            "joint": (joint,) * JOINTS,
            "drive": {"supply": self.supply},
        }
        return ArmParameters.model_validate(content)

    def log(self, name: str, time: Floats, leader: Floats, follower: Floats, voltage: Floats) -> Log:
        """A recording (s, rad, rad, V; a number a row each) as a log. A pitch is level at 0, where a pendulum hangs."""
        turn = -math.pi / 2 if self.joint == 1 else 0.0
        columns = np.zeros((3, len(time), JOINTS))
        columns[:, :, self.joint] = leader + turn, follower + turn, voltage
        return Log(
            name=name,
            origin=Origin(),
            time=time,
            leader=columns[0],
            follower=columns[1],
            voltage=columns[2],
            state=np.full(len(time), "following"),
            dropped=0,
            complete=True,
        )


# An Arduino, a potentiometer of ten turns, an H-bridge, a geared DC motor. No motor data are published: a small gear
# motor turns at some 2 rad/s under full supply, in a tenth of a second. Voltages are in proportion to 12 V.
POT_RIG = Rig("pot_servo", supply=12.0, inertia=0.6, damping=6.0)
POT_PERIOD_S = 2e-3
SERIAL_BYTES_PER_S = 115200 / 10

# A Dynamixel XL330-M288. Data sheet at 5 V: 0.52 N m at standstill, 103 turns a minute without load. The rotor's
# inertia is not given.
SERVO_ALPHA = 5.0 / 0.52
SERVO_RIG = Rig(
    "servo_pendulum",
    supply=7.4,
    alpha=SERVO_ALPHA,
    inertia=0.002 * SERVO_ALPHA,
    damping=5.0 / (103 * 2 * math.pi / 60),
    weight_kg=0.49,
    length_m=0.1,
)

# Driven by torque, 1.1 N m at most: 1 V stands for 1 N m. The inertia is the authors'; 0.01 N m s is a usual damping.
LEVER_RIG = Rig("lever_1dof", supply=15.0 * 0.075, inertia=1 / 631.36, damping=0.01)


def read_columns(path: Path, needed: Sequence[str]) -> dict[str, Floats]:
    """All columns by name; UserError in one sentence where the file cannot be read or a needed column is missing."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        names = rows[0] if rows else []
        values = np.array([[float(field) for field in row] for row in rows[1:]]).reshape(-1, len(names))
    except OSError as error:
        raise UserError(f"{path} cannot be read: {os_reason(error)}.", FAILED) from error
    except ValueError as error:
        raise UserError(f"{path} is no table of numbers: {error}.", FAILED) from error
    missing = [name for name in needed if name not in names]
    if missing:
        raise UserError(f"{path} has no column {missing[0]}; it has {', '.join(names) or 'none'}.", FAILED)
    return {name: np.ascontiguousarray(values[:, n]) for n, name in enumerate(names)}


def read_pot(path: Path) -> Log:
    """A row is a pass of the program; the relay's is ten."""
    c = read_columns(path, ("reference_rad", "position_rad", "u_percent"))
    relay = path.stem == "relay_method"
    seconds = np.full(len(c["u_percent"]), 10 * POT_PERIOD_S) if relay else _seconds_of_passes(c)
    time = np.concatenate([[0.0], np.cumsum(seconds)[:-1]])
    volts = c["u_percent"] / 100.0 * POT_RIG.supply
    return POT_RIG.log(path.stem, time, c["reference_rad"], c["position_rad"], volts)


def _seconds_of_passes(c: dict[str, Floats]) -> Floats:
    """2 ms, or as long as the serial port needs for the line that the program prints in each pass.

    The line is reference, position, error and control with two decimals, in degrees and thousandths of full duty, and
    the program waits while the port's buffer is full.
    """
    reference, angle = np.degrees(c["reference_rad"]), np.degrees(c["position_rad"])
    signals = (reference, angle, reference - angle, c["u_percent"] * 10.0)
    length = sum(np.char.str_len(np.char.mod("%.2f", signal)) for signal in signals) + 5  # blanks and the line's end
    seconds: Floats = np.maximum(length / SERIAL_BYTES_PER_S, POT_PERIOD_S)
    return seconds


def read_servo(path: Path) -> Log:
    c = read_columns(path, ("time_s", "leader_0", "follower_0", "load_raw"))
    volts = c["load_raw"] / FULL_PWM * SERVO_RIG.supply
    return SERVO_RIG.log(path.stem.removeprefix("xl330_"), c["time_s"], c["leader_0"], c["follower_0"], volts)


def read_lever(path: Path) -> Log:
    c = read_columns(path, ("time_s", "leader_0", "follower_0", "tau_cmd_follower_Nm"))
    name = path.stem.removeprefix("m2_").removesuffix("_500hz")
    return LEVER_RIG.log(name, c["time_s"], c["leader_0"], c["follower_0"], c["tau_cmd_follower_Nm"])
