"""The three rigs: what their authors publish, and nothing that was found out from the recordings."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from greywhale.base.errors import FAILED, UserError, os_reason
from greywhale.base.types import Floats
from studies.one_joint.law import (
    Law,
    proportional,
    proportional_derivative,
    proportional_resonant,
    relay,
    trapezoidal_pid,
)
from studies.one_joint.plant import Rig
from studies.one_joint.record import Record

Columns = dict[str, Floats]


def read_columns(path: Path, needed: Sequence[str]) -> Columns:
    """All columns by name; UserError in one sentence where the file cannot be read or a needed column is missing."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
    except OSError as error:
        raise UserError(f"{path} cannot be read: {os_reason(error)}.", FAILED) from error
    names = rows[0] if rows else []
    missing = [name for name in needed if name not in names]
    if missing:
        raise UserError(f"{path} has no column {missing[0]}; it has {', '.join(names) or 'none'}.", FAILED)
    try:
        values = np.array([[float(field) for field in row] for row in rows[1:]])
    except ValueError as error:
        raise UserError(f"{path} holds something that is no number: {error}.", FAILED) from error
    if values.ndim != 2 or values.shape[1] != len(names):
        raise UserError(f"{path} has rows of another length than its {len(names)} column names.", FAILED)
    return {name: np.ascontiguousarray(values[:, n]) for n, name in enumerate(names)}


@dataclass(frozen=True)
class Source:
    """A file with the rig that made it and the controller that it was made with."""

    rig: Rig
    record: Record
    law: Law


@dataclass(frozen=True)
class Collection:
    """One folder of recordings; `credit`: author, place, licence."""

    folder: str
    credit: str
    files: tuple[str, ...]
    read: Callable[[Path], Source]


# --- gkeiel/dc_motor_position_control: an Arduino, a potentiometer of ten turns, an H-bridge, a geared DC motor.

DEGREE = math.pi / 180.0
POT_SUPPLY = 12.0  # V; not published, so every voltage is in proportion to it
POT_STEP = 450.0 / 128.0 * DEGREE  # of the 10-bit converter, as its program has it
POT_PERIOD = 2e-3
POT_FULL = 1000.0  # the program's full duty
SERIAL_BYTES_PER_S = 115200 / 10
# No motor data are published: a small gear motor that turns at some 2 rad/s under full supply, in a tenth of a second.
POT_RIG = Rig("pot_servo", supply=POT_SUPPLY, inertia=0.6, damping=6.0)


def _pot_row_seconds(c: Columns) -> Floats:
    """How long each pass of the program took: 2 ms, or as long as the serial port needs for the line it prints.

    The program prints reference, position, error and control with two decimals at 115,200 baud in every pass, and
    waits while the port's buffer is full.
    """
    signals = (c["reference_rad"] / DEGREE, c["position_rad"] / DEGREE, c["error_deg"], c["u_percent"] * 10.0)
    texts = [np.char.mod("%.2f", signal) for signal in signals]
    length = sum(np.char.str_len(text) for text in texts) + 5  # three blanks, carriage return, line feed
    seconds: Floats = np.maximum(length / SERIAL_BYTES_PER_S, POT_PERIOD)
    return seconds


def _pot_law(name: str) -> tuple[Law, int]:
    volts = POT_SUPPLY / POT_FULL / DEGREE  # the programs reckon in degrees and thousandths of full duty
    if name == "pid_step":
        law = trapezoidal_pid(
            46.3 / 5 * volts, 13 * volts, 0.05 * volts, 1.0, POT_PERIOD, POT_SUPPLY, 124.6 * POT_SUPPLY / POT_FULL
        )
        return law, 1
    if name == "pr":
        return proportional_resonant(92.6 * volts, 200 * volts, 2 * math.pi * 0.1, POT_PERIOD, POT_SUPPLY), 1
    return relay(POT_SUPPLY, 4.0 * DEGREE, 10), 10


def read_pot(path: Path) -> Source:
    c = read_columns(path, ("time_nominal_s", "reference_rad", "position_rad", "u_percent"))
    law, passes = _pot_law(path.stem)
    if passes == 1:
        time = np.concatenate([[0.0], np.cumsum(_pot_row_seconds(c))[:-1]])
    else:
        time = np.arange(len(c["time_nominal_s"])) * POT_PERIOD * passes
    record = Record(
        name=path.stem,
        time=time,
        leader=c["reference_rad"],
        follower=c["position_rad"],
        volts=c["u_percent"] / 100.0 * POT_SUPPLY,
        load=np.zeros(len(time)),
        leader_lines=False,
        volts_lines=False,
        resolution=POT_STEP,
    )
    return Source(POT_RIG, record, law)


# --- Rhoban/bam: a Dynamixel XL330-M288 swings a weight on a rod.

SERVO_SUPPLY = 7.4  # V
SERVO_FULL = 885.0  # of the register Present PWM
SERVO_COUNTS = 4096 / (2 * math.pi)
SERVO_DIVISOR = 256.0  # of the register Position P Gain, by the authors' measurement
WEIGHT_KG, ROD_M, GRAVITY = 0.49, 0.1, 9.80665
# Data sheet at 5 V: 0.52 N m at standstill, 103 turns a minute without load. The rotor's inertia is not given.
SERVO_ALPHA = 5.0 / 0.52
SERVO_RIG = Rig(
    "servo_pendulum",
    supply=SERVO_SUPPLY,
    alpha=SERVO_ALPHA,
    inertia=0.002 * SERVO_ALPHA,
    damping=5.0 / (103 * 2 * math.pi / 60),
    link_inertia=WEIGHT_KG * ROD_M**2,
    weight=WEIGHT_KG * GRAVITY * ROD_M,
    zero_known=True,
)


def read_servo(path: Path) -> Source:
    c = read_columns(path, ("time_s", "leader_0", "follower_0", "load_raw"))
    gain = 400.0 if "kp400" in path.stem else 200.0
    record = Record(
        name=path.stem.removeprefix("xl330_"),
        time=c["time_s"],
        leader=c["leader_0"],
        follower=c["follower_0"],
        volts=c["load_raw"] / SERVO_FULL * SERVO_SUPPLY,
        load=np.zeros(len(c["time_s"])),
        leader_lines=False,
    )
    law = proportional(gain * SERVO_COUNTS / SERVO_DIVISOR / SERVO_FULL * SERVO_SUPPLY, SERVO_SUPPLY, 5)
    return Source(SERVO_RIG, record, law)


# --- Ohara124c41/Haptics-Bilateral_Teleoperation-1DOF_Experiments: two levers, coupled by a controller, 2 kHz.

LEVER_LIMIT = 15.0 * 0.075  # N m, the authors' greatest allowed torque
LEVER_GAINS = {"a": (8.0, 0.1), "b": (15.0, 0.1), "c": (25.0, 0.15)}
# Driven by torque: 1 V stands for 1 N m. The inertia is the authors'; 0.01 N m s is a usual damping for its size.
LEVER_RIG = Rig("lever_1dof", supply=LEVER_LIMIT, inertia=1 / 631.36, damping=0.01, window_s=0.2)
LEVER_PERIOD = 0.5e-3


def read_lever(path: Path) -> Source:
    c = read_columns(path, ("time_s", "leader_0", "follower_0", "tau_env_Nm", "tau_cmd_follower_Nm"))
    kp, kd = LEVER_GAINS[path.stem.split("_")[1]]
    free = "free_motion" in path.stem
    record = Record(
        name=path.stem.removeprefix("m2_").removesuffix("_500hz"),
        time=c["time_s"],
        leader=c["leader_0"],
        follower=c["follower_0"],
        volts=c["tau_cmd_follower_Nm"],
        # Where the lever moves freely nothing pushes it, and the sensor shows only how far its zero has drifted.
        load=np.zeros(len(c["time_s"])) if free else -c["tau_env_Nm"],
    )
    return Source(
        replace(LEVER_RIG, loaded=not free), record, proportional_derivative(kp, kd, LEVER_LIMIT, LEVER_PERIOD, 4)
    )


COLLECTIONS = (
    Collection(
        "pot_servo",
        "gkeiel/dc_motor_position_control on GitHub, MIT licence",
        ("pid_step.csv", "pr.csv", "relay_method.csv"),
        read_pot,
    ),
    Collection(
        "servo_pendulum",
        "Rhoban/bam on GitHub, branch xl330, Apache-2.0 licence",
        (
            "xl330_kp200_sin_sin.csv",
            "xl330_kp200_up_and_down.csv",
            "xl330_kp400_sin_sin.csv",
            "xl330_kp400_up_and_down.csv",
        ),
        read_servo,
    ),
    Collection(
        "lever_1dof",
        "Ohara124c41/Haptics-Bilateral_Teleoperation-1DOF_Experiments on GitHub, MIT licence",
        (
            "m2_a_free_motion_500hz.csv",
            "m2_b_free_motion_500hz.csv",
            "m2_c_free_motion_500hz.csv",
            "m2_b_spring_500hz.csv",
        ),
        read_lever,
    ),
)
