"""Sinking: an arm three times as heavy as its file goes down against its motor; a clause has the volts that hold it."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from greywhale.arm.body import Body
from greywhale.arm.plant import Arm
from greywhale.arm.plants import plant_row
from greywhale.commission.sinking import describe_sinking
from greywhale.files.arm import load_arm
from greywhale.files.log import Log
from greywhale.files.log.layout import Origin

WHITE = load_arm("white_box")
SHOULDER, POSE = 1, (0.0, 0.4, 0.0, 0.0)
TICKS = 400


def sinking(volts: float, leader_rad: float) -> Log:
    """The shoulder of the heavy arm at these volts, its leader beside where it began."""
    heavy = WHITE.model_copy(update={"gravity": 3.0 * WHITE.gravity})
    plant = Arm(heavy)
    plant.reset(POSE)
    voltage = np.tile([0.0, volts, 0.0, 0.0], (TICKS, 1))
    follower = np.array([plant.step(row, 1e-3) for row in voltage], dtype=np.float64)
    leader = np.tile(POSE, (TICKS, 1)) + leader_rad
    state = np.full(TICKS, "following")
    time = np.linspace(0.0, 1e-3 * TICKS, TICKS, endpoint=False)
    return Log("log.csv", Origin(), time, leader, follower, voltage, state, 0, False)


def hold_v(pose: np.ndarray) -> float:
    gravity = 3.0 * Body.of(plant_row(WHITE)).bias(pose[None], np.zeros((1, 4)))[0, SHOULDER]
    return float(gravity / WHITE.actuator(SHOULDER).torque_per_volt)


def test_the_clause_has_the_volts_that_hold_the_weight() -> None:
    needed = hold_v(np.array(POSE))
    log = sinking(0.4 * needed, 0.0)
    assert (log.follower[-1, SHOULDER] - POSE[SHOULDER]) * np.sign(needed) < -0.1, "it sank"
    clause = describe_sinking(log, SHOULDER, WHITE)
    found = re.fullmatch(r", and joint 1 \(shoulder pitch\) sank against (.*) V: .* about (\S+) V to hold .*", clause)
    assert found is not None, clause
    assert float(found[1]) == pytest.approx(0.4 * abs(needed), abs=0.05)
    assert float(found[2]) == pytest.approx(abs(hold_v(log.follower[-1])), rel=0.25)
    weak = WHITE.model_copy(update={"drive": WHITE.drive.model_copy(update={"supply": 1.0})})
    assert describe_sinking(log, SHOULDER, weak).endswith(", more than its supply of 1 V")


def test_a_joint_that_rises_or_that_its_leader_sends_down_did_not_sink() -> None:
    needed = hold_v(np.array(POSE))
    log, down = sinking(0.4 * needed, 0.0), -float(np.sign(needed))
    assert describe_sinking(sinking(1.6 * needed, 0.0), SHOULDER, WHITE) == ""
    assert describe_sinking(sinking(0.4 * needed, 2.0 * down), SHOULDER, WHITE) == ""
    assert describe_sinking(replace(log, voltage=-log.voltage), SHOULDER, WHITE) == ""
    assert describe_sinking(log, 0, WHITE) == "", "a yaw bears no weight"
