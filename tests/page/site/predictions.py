"""Predictions of the host for a page to repeat, and their measures as in a log; arms that the host refuses."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.dashboard.predict import ROW_EVERY_TICKS, Motion, Prediction, predict
from greywhale.files.arm import content_of, load_arm
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


ARMS = ("worn", "white_box")  # with play and lag; by the paper's equation of a motor
SLIPS = (
    ("motor_equation = ", "motor_equation = 3 #"),
    ('motor_equation = "physical"', 'motor_equation = "physics"'),
    ("supply = ", "supply = 0 #"),
    ("supply = ", "supplies = "),
    ("mass = ", "mass = 1e-12 #"),
    ("[[joint]]", "[[joint]]\nfixed = 1"),
    ("[[joint]]", "[[join]]"),
    ("gear_ratio = ", "gear_ratio = -"),
    ("direction = ", "direction = 2"),
)


def predictions() -> list[dict[str, Any]]:
    default = load_arm("default")
    cases = [_case(predict(default, table), table, "") for table in TABLES]
    return cases + [_case(predict(load_arm(name), USUAL), USUAL, content_of(name).decode()) for name in ARMS]


def _case(told: Prediction, table: ParameterTable, arm: str) -> dict[str, Any]:
    asked = {"arm": arm, "raw": list(table.raw), "board": int(table.board)}
    return {**asked, "prediction": told, "answers": [_answer(told["step"], joint) for joint in range(4)]}


def spoilt_arms() -> list[dict[str, str]]:
    """Texts that are no arms, with the host's sentence."""
    sound, path, cases = content_of("worn").decode(), Path("arm.toml"), []
    for slip, made in SLIPS:
        text = sound.replace(slip, made, 1)
        assert text != sound, slip
        path.write_text(text, "utf-8")
        with pytest.raises(UserError) as refused:
            load_arm(path)
        cases.append({"text": text, "error": refused.value.message})
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
