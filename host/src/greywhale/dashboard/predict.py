"""Predicts how an arm follows with controllers that nobody has uploaded yet: a step and a reach of every joint."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, TypedDict

import numpy as np
import numpy.typing as npt

from greywhale.arm.parameters import ArmParameters
from greywhale.arm.plants import plant_row
from greywhale.base.types import Floats
from greywhale.loop import Experiment, controllers_of
from greywhale.loop.leader import SLICE_S, straight_slices
from greywhale.loop.leader_motions import EDGE_S, RATE_HZ, minimum_jerk
from greywhale.protocol.firmware import JOINTS, TICK_S
from greywhale.protocol.table import ParameterTable

# The motions that are predicted, of every joint: a step as steep as a hand can, and a reach for something.
STEP_RAD, REACH_RAD, REACH_S = 0.5, 1.0, 0.8
BEFORE_S, AFTER_S = 0.2, 1.3  # rest before the motion, and time to settle
ROW_SLICES = round(1.0 / RATE_HZ / SLICE_S)  # slices between two rows of the leader
DIGITS = 5  # of the leader's angles in rad: a page has the same ones
# Ticks between two rows of the answer.
ROW_EVERY_TICKS = 5
SEED = 1  # of where each gear stands in its gap; any one, the same every time
# What a board knows of its arms' potentiometers and wires is none of the model's.
_CALIBRATION = ("leader", "follower")


class Motion(TypedDict):
    """A predicted motion: a row each `ROW_EVERY_TICKS` ticks, a column a joint; `mse` in rad2 over the whole motion."""

    time_s: list[float]
    leader: list[list[float]]  # rad
    follower: list[list[float]]  # rad
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
    return {"step": _follow(arm, board, motions()["step"]), "reach": _follow(arm, board, motions()["reach"])}


def _follow(arm: ArmParameters, table: ParameterTable, rows: Floats) -> Motion:
    slices = straight_slices(rows, ROW_SLICES, BEFORE_S)
    experiment = Experiment(slices, arm, table=table, seed=SEED, noise=False, soft_start=False)
    result = experiment.run(controllers_of(table)[None], plant_row(arm)[None], every=ROW_EVERY_TICKS, threads=1)
    return {
        "time_s": _rounded(np.arange(len(result.time_s)) * ROW_EVERY_TICKS * TICK_S),
        "leader": _rounded(experiment.leader[::ROW_EVERY_TICKS]),
        "follower": _rounded(np.nan_to_num(result.angles[0].astype(np.float64), nan=10.0)),
        "mse": result.mse[0].tolist(),
    }


def _rounded(values: npt.NDArray[Any]) -> Any:
    """Numbers to the digits that can be seen, as lists."""
    return np.round(values, 4).tolist()


@lru_cache(1)
def motions() -> dict[str, Floats]:
    """The leader's angles (rows, 4) in each motion, after the rest before it."""
    return {"step": _move(STEP_RAD, EDGE_S), "reach": _move(REACH_RAD, REACH_S)}


def _move(size_rad: float, takes_s: float) -> Floats:
    """One move of every joint, and time to settle: a row each `ROW_SLICES`."""
    time_s = np.arange(round((takes_s + AFTER_S) * RATE_HZ) + 1) / RATE_HZ
    angle = np.round(size_rad * minimum_jerk(time_s / takes_s), DIGITS)
    return np.tile(angle[:, None], (1, JOINTS))
