"""Predicts how an arm follows with controllers that nobody has uploaded yet: a step and a reach of every joint."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, TypedDict

import numpy as np
import numpy.typing as npt
import scipy.interpolate  # noqa: F401 # a trajectory would load it when it is first asked for an angle

from greywhale.arm.parameters import ArmParameters
from greywhale.arm.plants import plant_row
from greywhale.files.trajectory import Trajectory
from greywhale.loop import Experiment, controllers_of
from greywhale.loop.leader_motions import RATE_HZ, minimum_jerk, multi_steps
from greywhale.protocol.firmware import JOINTS, TICK_S, pwm_steps
from greywhale.protocol.table import ParameterTable

STEP_RAD, REACH_RAD, REACH_S = 0.5, 1.0, 0.8  # the motions that are predicted, of every joint
BEFORE_S, AFTER_S = 0.2, 1.3  # rest before the motion, and time to settle
# Ticks between two rows of the answer.
ROW_EVERY_TICKS = 5
# What a board knows of its arms' potentiometers and wires is none of the model's.
_CALIBRATION = ("leader", "follower")


class Motion(TypedDict):
    """A predicted motion: a row each `ROW_EVERY_TICKS` ticks, a column a joint; `mse` in rad2 over the whole motion."""

    time_s: list[float]
    leader: list[list[float]]  # rad
    follower: list[list[float]]  # rad
    voltage: list[list[float]]  # V
    mse: list[float]


class Prediction(TypedDict):
    step: Motion
    reach: Motion


def predict(arm: ArmParameters, table: ParameterTable) -> Prediction:
    """Predict the arm under a parameter table's controllers and settings, wired and calibrated rightly."""
    usual = ParameterTable.defaults(table.board)
    keys = {name: raw for name, raw in table.by_name().items() if not name.startswith(_CALIBRATION)}
    board = usual.with_raw({name: raw for name, raw in keys.items() if not name.endswith("motor_sign")})
    board = board.with_joints(arm.joints_in_use)
    return {"step": _follow(arm, board, _step()), "reach": _follow(arm, board, _reach())}


def _follow(arm: ArmParameters, table: ParameterTable, leader: Trajectory) -> Motion:
    experiment = Experiment(leader, arm, table=table, noise=False, wait_s=BEFORE_S, soft_start=False)
    result = experiment.run(controllers_of(table)[None], plant_row(arm)[None], every=ROW_EVERY_TICKS, threads=1)
    volts = table.supply_v / np.array(pwm_steps(table.board))
    return {
        "time_s": _rounded(np.arange(len(result.time_s)) * ROW_EVERY_TICKS * TICK_S),
        "leader": _rounded(experiment.leader[::ROW_EVERY_TICKS]),
        "follower": _rounded(np.nan_to_num(result.angles[0].astype(np.float64), nan=10.0)),
        "voltage": _rounded(result.duties[0] * volts),
        "mse": [float(f"{one:.4g}") for one in result.mse[0]],
    }


def _rounded(values: npt.NDArray[Any]) -> Any:
    """Numbers to the digits that can be seen, as lists."""
    return np.round(values, 4).tolist()


@lru_cache(1)
def _step() -> Trajectory:
    """As steep as a hand can."""
    return multi_steps([0.0, STEP_RAD], [BEFORE_S, AFTER_S])


@lru_cache(1)
def _reach() -> Trajectory:
    """As a person reaches for something."""
    time_s = np.arange(round((REACH_S + AFTER_S) * RATE_HZ) + 1) / RATE_HZ
    angle = REACH_RAD * minimum_jerk(time_s / REACH_S)
    return Trajectory(time_s, np.tile(angle[:, None], (1, JOINTS)))
