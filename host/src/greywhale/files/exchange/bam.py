"""One joint of a log as a recording of Rhoban's BAM (better actuator models): JSON with an entry for each sample.

https://github.com/Rhoban/bam, bam/dynamixel/record.py. There `load` is the motor's duty in thousandths, with its sign,
of `input_volts`, the supply; of an XL330 it is the register Present PWM, or in newer recordings the duty itself. What
this arm does not have is left out (`temp`) or null (`kp`: the law is no gain).
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import IO

import numpy as np

from greywhale.base.errors import BadUsage, UserError
from greywhale.base.formats.whole import write_whole
from greywhale.base.types import Floats
from greywhale.files.exchange.recording import ExportOptions, Recording
from greywhale.files.log.layout import QUANTITIES, STATES

FULL_LOAD = 1000.0  # of the load where the duty is 1
FULL_PWM = 885.0  # the same of an XL330's register
# Of ours, which BAM passes over: the board's clock at timestamp 0 in s, and the joint.
START, JOINT = "start_s", "joint"
POWERED = ("soft_start", "following")


def full_load(motor: object, load: Floats) -> float:
    """The load where the duty of this motor is 1."""
    if not str(motor).startswith("xl330"):
        return FULL_LOAD
    return FULL_PWM if np.abs(load).max() > 1.0 else 1.0


def write(recordings: Iterable[Recording], out: Path, options: ExportOptions) -> list[Path]:
    """Write one joint of one recording. UserError where the log does not tell the supply."""
    (one,) = recordings
    log, joint = one.log, options.joint
    if joint is None or options.mass is None or options.length is None:
        raise BadUsage("--to bam needs --joint, and --mass and --length of the pendulum that this joint swings.")
    if joint not in log.joints_in_use:
        raise BadUsage(f"--joint {joint}: {log.name} does not use this joint.")
    if log.origin.table is None:
        raise UserError(
            f"{log.name}: its header has no parameters, so nothing tells the supply, of which BAM wants the motor's "
            "share; take a log that `greywhale record` wrote."
        )
    supply = log.origin.table.supply_v
    head = {"mass": options.mass, "length": options.length, "kp": None, "vin": supply, "motor": "greywhale"}
    head |= {"trajectory": Path(log.name).stem, START: float(log.time[0]), JOINT: joint}

    def fill(file: IO[bytes]) -> None:
        file.write(json.dumps(head)[:-1].encode() + b', "entries": [\n')
        for number, text in enumerate(_entries(one, joint, supply)):
            file.write((b",\n" if number else b"") + text.encode())
        file.write(b"\n]}\n")

    write_whole(out, fill)
    return [out]


def _entries(one: Recording, joint: int, supply: float) -> Iterator[str]:
    log = one.log
    leader, follower, voltage = (log.held(name)[:, joint] for name in QUANTITIES)
    speed = np.gradient(follower, log.time)
    powered = np.array([word in POWERED for word in STATES])
    for rows in one.chunks():
        columns = {
            "position": follower[rows],
            "speed": speed[rows],
            "load": FULL_LOAD * voltage[rows] / supply,
            "timestamp": np.round(log.time[rows] - log.time[0], 6),
            "goal_position": leader[rows],
            "torque_enable": powered[log.places[rows]],
        }
        for values in zip(*(column.tolist() for column in columns.values()), strict=True):
            yield json.dumps(dict(zip(columns, values, strict=True)) | {"input_volts": supply})
