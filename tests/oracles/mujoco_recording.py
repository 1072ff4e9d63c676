"""An arm that MuJoCo simulates, in closed loop with the firmware's own controller, recorded as a log.

Friction is MuJoCo's frictionloss (a soft constraint), the rotor its armature, integration its own; sampling, filter and
noise of the potentiometers are written out here. Nothing of greywhale's plant takes part.
"""

from __future__ import annotations

import math
from pathlib import Path

import mujoco
import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.export import mjcf
from greywhale.files.log import Log, LogWriter, read_log
from greywhale.files.log.layout import Origin
from greywhale.files.trajectory import Trajectory
from greywhale.fuzzy.settings import JointSettings
from greywhale.protocol.firmware import ANGLE_LSB, JOINTS
from greywhale.protocol.table import ParameterTable
from tools.support.foreign_gears import Gears, with_rotors

STEP_S = 1e-4
STEPS = 10  # of MuJoCo in a tick of 1 ms
CONVERSIONS = (1, 3, 5, 7)  # steps into a tick at which a potentiometer is converted
NEW_DUTY = 3  # steps into a tick from which its voltage drives
TRACK = math.radians(300.0)
SETTLING_S = 1.5
USUAL_SOFTNESS = (0.02, 1.0), (0.9, 0.95, 0.001, 0.5, 2.0)  # of MuJoCo's friction; the exported file makes it stiffer


class Board:
    """The firmware's work on four conversions a tick: filter, scale, control."""

    def __init__(self, table: ParameterTable) -> None:
        self._supply = table["supply_mv"]
        self._share = 1.0 / (1 << table["filter_shift"])
        self._laws = [JointSettings(*row).controller(table.period_ms) for row in table.controllers]
        self._filtered: np.ndarray | None = None
        self.reading = np.zeros(JOINTS, dtype=np.int16)
        self.volts = np.zeros(JOINTS)

    def tick(self, leader: np.ndarray, conversions: np.ndarray) -> None:
        """`leader` in 1/4096 rad, `conversions` (4, joints) in counts."""
        mean = conversions.mean(axis=0)
        self._filtered = mean if self._filtered is None else self._filtered + (mean - self._filtered) * self._share
        self.reading = np.round((self._filtered + 0.5 - 512.0) / 1024.0 * TRACK / ANGLE_LSB).astype(np.int16)
        limit = np.array([self._supply], dtype=np.uint16)
        for joint, law in enumerate(self._laws):
            out = law.run(leader[joint : joint + 1], self.reading[joint : joint + 1], limit)
            self.volts[joint] = out["volts_mv"][0] / 1000.0


def record(
    arm: ArmParameters,
    motion: Trajectory,
    path: Path,
    table: ParameterTable,
    noise_v: float,
    seed: int,
    play: float = 0.0,
    gears: Gears | None = None,
) -> Log:
    """Play `motion` (rad) on MuJoCo's arm and write the log `path` from 1.5 s after the motors went on.

    The joints drag their potentiometers along with `play` (rad) to either side. With `gears` the motors, and with them
    armature and friction, are apart from the joints.
    """
    model = mujoco.MjModel.from_xml_string(mjcf(arm) if gears is None else with_rotors(arm))
    model.dof_solref[:], model.dof_solimp[:] = USUAL_SOFTNESS
    model.opt.timestep = STEP_S
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    data = mujoco.MjData(model)
    random = np.random.default_rng(seed)
    before = round(SETTLING_S * 1000)
    ticks = int(motion.time_s[-1] * 1000)
    leader = np.column_stack([np.interp(np.arange(ticks) / 1000, motion.time_s, angles) for angles in motion.angles.T])
    leader = np.round(np.vstack([np.tile(leader[:1], (before, 1)), leader]) / ANGLE_LSB).astype(np.int16)
    joints = data.qpos[:JOINTS]
    data.qpos[:] = np.resize(leader[0] * ANGLE_LSB, model.nq)
    wiper = joints.copy()
    board = Board(table)
    noise = noise_v / 5.0 * 1024.0
    counts = np.zeros((len(CONVERSIONS), JOINTS))
    origin = Origin("0.1.0", "mega2560", table.crc, 1, 1)
    with LogWriter(path, origin) as log:
        for tick, target in enumerate(leader):
            for step in range(STEPS):
                if step == NEW_DUTY:
                    data.ctrl[:] = board.volts
                if step in CONVERSIONS:
                    wiper = np.clip(wiper, joints - play, joints + play)
                    ideal = (wiper / TRACK + 0.5) * 1024.0
                    counts[CONVERSIONS.index(step)] = np.floor(ideal + noise * random.standard_normal(JOINTS))
                if gears is not None:
                    data.qfrc_applied[:] = gears.pushes(data.qpos, data.qvel)
                mujoco.mj_step(model, data)
            board.tick(target, counts)
            if tick >= before:
                log.append(
                    (tick - before) / 1000, target * ANGLE_LSB, board.reading * ANGLE_LSB, board.volts, "following"
                )
    return read_log(path)
