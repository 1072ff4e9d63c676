"""Recordings of arms that the identification must not know: the native closed loop plays the bench, the log is all
that leaves this file.

The follower's readings are made as the firmware makes them: four 10-bit conversions in a tick of noisy potentiometers,
filtered, scaled to 1/4096 rad.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters, Potentiometers
from greywhale.base.types import Floats
from greywhale.files import controller
from greywhale.files.arm import load_arm
from greywhale.files.log import Log, LogWriter, read_log
from greywhale.files.log.layout import Origin
from greywhale.files.trajectory import Trajectory
from greywhale.loop import Experiment, human_reaches
from greywhale.protocol.firmware import ANGLE_LSB, JOINTS, pwm_steps
from greywhale.protocol.table import ParameterTable
from greywhale_paper.work.drawn_arms import draw_arm
from tools import ROOT

TABLES = ROOT / "shared" / "fuzzy_tables"
# Within a tick, when the four conversions of a follower's potentiometer hold their input (ms).
MOMENTS = (0.1, 0.3, 0.5, 0.7)
SUPPLY = 15.0
PLAY_RAD = (0.001, 0.010)
MOST_LOAD = 0.15  # of the torque passed on, as friction
START_S = 1.5  # the log begins that long after the motors went on, as `greywhale record` does


@dataclass(frozen=True)
class Recorded:
    """Three logs of one arm: to fit, to validate, and to validate with another controller."""

    fit: Log
    second: Log
    changed: Log


def table_of(name: str) -> ParameterTable:
    """A whole parameter table with the controllers of shared/fuzzy_tables/`name`.toml."""
    return controller.load(TABLES / f"{name}.toml").table().with_name(name)


def record(
    arm: ArmParameters,
    motion: Trajectory,
    path: Path,
    table: ParameterTable | None = None,
    seed: int = 1,
    every: int = 1,
) -> Log:
    """Record `motion` on the table's board into the log `path`, a row every `every` ticks."""
    table = ParameterTable.defaults() if table is None else table
    experiment = Experiment(motion, arm, table=table, seed=seed, wait_s=START_S + 0.1)
    result = experiment.run_exact(every=1)
    if result.diverged[0]:
        raise RuntimeError("the recorded arm left the range of numbers")
    follower = readings_of(np.asarray(result.angles[0], dtype=np.float64), arm, table, seed)
    volts = result.duties[0].astype(np.float64) / pwm_steps(table.board) * arm.drive.supply
    origin = Origin("0.1.0", table.board.key, table.crc, table.period_ms, every, joints=table.joints_in_use)
    first = round(START_S * 1000)
    with LogWriter(path, origin) as log:
        shown = (experiment.reference * ANGLE_LSB, follower, volts)
        rows = zip(*(one[first : len(volts) : every].tolist() for one in shown), strict=True)
        for row, (leader, angles, drives) in enumerate(rows):
            log.append(row * every / 1000, leader, angles, drives, "following")
    return read_log(path)


def readings_of(angles: Floats, arm: ArmParameters, table: ParameterTable, seed: int) -> Floats:
    """The firmware's readings of the true angles at every tick."""
    pots = Potentiometers(arm.follower_pots, seed + 1)
    shift = table["filter_shift"]
    before = np.vstack([angles[:1], angles[:-1]])
    between = np.stack([before + moment * (angles - before) for moment in MOMENTS], axis=1)
    millivolts = np.empty_like(between)
    for row, out in zip(between.reshape(-1, JOINTS), millivolts.reshape(-1, JOINTS), strict=True):
        pots.millivolts(row, out)
    counts = np.minimum(np.floor(millivolts / (1000.0 * arm.follower_pots.supply) * 1024.0), 1023.0)
    parts = float(1 << shift)
    filtered = np.array(list(accumulate(counts.sum(axis=1) * 4.0, lambda old, new: old + (new - old) / parts)))
    zero, scale = np.array(table.each("follower", "zero")), np.array(table.each("follower", "scale"))
    readings: Floats = np.floor((filtered - zero) * scale / 8192.0 + 0.5) * ANGLE_LSB
    return readings


def random_arm(seed: int) -> ArmParameters:
    """An arm drawn around the white box."""
    return draw_arm(load_arm("white_box"), seed)


def worn_arm(seed: int) -> ArmParameters:
    """A random arm with play at its potentiometers and load friction."""
    random = np.random.default_rng(500 + seed)
    data = random_arm(seed).model_dump()
    for pot, play in zip(data["follower_pots"]["joint"], random.uniform(*PLAY_RAD, JOINTS), strict=True):
        pot["play"] = float(play)
    for joint in data["joint"]:
        joint["friction"]["load"] = float(random.uniform(0.0, MOST_LOAD))
    return ArmParameters.model_validate(data, strict=False)


def record_three(arm: ArmParameters, folder: Path, seed: int = 1, seconds: float = 30.0) -> Recorded:
    """The fitting log, a second one, and one with the controllers of the paper's Table 10."""
    before, after = table_of("before_tuning"), table_of("table_10")
    return Recorded(
        record(arm, human_reaches(10 * seed + 1, seconds), folder / "fit.csv", before, 10 * seed + 1),
        record(arm, human_reaches(10 * seed + 2, seconds), folder / "second.csv", before, 10 * seed + 2),
        record(arm, human_reaches(10 * seed + 3, seconds), folder / "changed.csv", after, 10 * seed + 3),
    )
