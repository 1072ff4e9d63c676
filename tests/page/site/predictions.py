"""Predictions of the host for the default arm, for a page without a host to repeat, and their measures in a log."""

from __future__ import annotations

from typing import Any

import numpy as np

from greywhale.dashboard.predict import ROW_EVERY_TICKS, Motion, predict
from greywhale.files.arm import load_arm
from greywhale.measure.runs import REST_RAD, REST_S, periods, resting
from greywhale.measure.step_response import answer, departures
from greywhale.protocol.firmware import TICK_S
from greywhale.protocol.schema import Board
from greywhale.protocol.table import ParameterTable

PERIOD_S = ROW_EVERY_TICKS * TICK_S
USUAL = ParameterTable.defaults()
TABLES = (
    USUAL,
    USUAL.with_raw({"joint0.kp": 4 * USUAL["joint0.kp"], "joint2.ze_c": 900, "joint3.ki": 0, "joint1.ce_ticks": 7}),
    USUAL.with_raw({"supply_mv": 7000, "joint2.limit_max": 1500, "filter_shift": 2, "joint1.motor_sign": -1}),
    USUAL.with_raw({"period_ms": 20, "follower0.zero": 300, "leader3.scale": -USUAL["leader3.scale"]}),
    ParameterTable.defaults(Board.NANO328),
)


def predictions() -> list[dict[str, Any]]:
    arm, cases = load_arm("default"), []
    for table in TABLES:
        told = predict(arm, table)
        asked = {"raw": list(table.raw), "board": int(table.board)}
        cases.append({**asked, "prediction": told, "answers": [_answer(told["step"], joint) for joint in range(4)]})
    return cases


def _answer(motion: Motion, joint: int) -> tuple[float, float | None] | None:
    """Overshoot and settling time of a step, as a log's are found; None for one that was too short."""
    rest = periods(REST_S, PERIOD_S)
    # A log knows that the leader rests only after a while.
    leader, follower = (
        np.concatenate([np.full(rest, rows[0, joint]), rows[:, joint], np.full(rest, rows[-1, joint])])
        for rows in (np.array(motion["leader"]), np.array(motion["follower"]))
    )
    still = resting(leader, rest, REST_RAD)
    (step,) = departures(leader, still, PERIOD_S)
    found = answer(leader, follower, still, step, PERIOD_S)
    return None if found is None else (found.overshoot_percent, found.settling_s)
