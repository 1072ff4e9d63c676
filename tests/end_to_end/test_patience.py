"""A joint that does not go where its voltage should have moved it: an ordinary hand or a worn arm is no fault."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.arm import ArmParameters, PotFault
from greywhale.files import controller
from greywhale.files.arm import load_arm
from greywhale.files.leader import save_leader
from greywhale.files.model import to_toml
from greywhale.files.paper_tables import paper_table
from greywhale.loop import human_reaches
from greywhale.protocol.schema import Fault, State
from greywhale.protocol.table import ParameterTable
from greywhale.tune.travel import travel_of
from tests.end_to_end.test_lock_step import set_parameters
from tests.support.arms import make_arm

pytestmark = pytest.mark.slow
PLAY_RAD, FRICTION_V, GRIPPED_KG, LEANS_V = 0.05, 2.0, 0.5, 3.0
HEAVY = make_arm(tip={"mass": 0.9})
STALLED_S = 4


def worn() -> ArmParameters:
    """The default arm with 50 mrad of play and dry friction of 2 V in each joint."""
    torques = [FRICTION_V * load_arm("default").actuator(joint).torque_per_volt for joint in range(4)]
    friction = {number: {"friction": {"coulomb": one, "breakaway": 1.2 * one}} for number, one in enumerate(torques)}
    return make_arm(every_joint={"gear": {"half_gap": PLAY_RAD / 2}}, joint=friction)


def travel(arm: ArmParameters) -> dict[str, int]:
    """The travel by `greywhale tune` of an arm whose model is exact."""
    found = travel_of(arm, ParameterTable.defaults(), samples=1)
    assert found is not None
    return found.raw()


def tuned() -> dict[str, int]:
    """The paper's tuned controllers, which push harder than those that the board has at first."""
    return {key: int(raw) for key, raw in controller.load(paper_table("table_10")).raw_values().items()}


def lead(host: Any, joint: int, angle: float, seconds: float) -> None:
    """The person leads one joint there, the others to 0, and waits."""
    host.bench.leader.lead(np.eye(4)[joint] * angle)
    host.run(seconds)


def following(host: Any) -> bool:
    status = host.status()
    assert status.fault is Fault.NONE, f"{status.fault} of joint {status.fault_where}"
    return bool(status.state is State.FOLLOWING)


def test_an_arm_with_play_and_friction_follows_a_person(lock_step: Any, tmp_path: Path) -> None:
    (tmp_path / "arm.toml").write_text(to_toml(worn(), {}), encoding="utf-8")
    save_leader(tmp_path / "leader.csv", human_reaches(3, 10.0))
    host = lock_step(arm=tmp_path / "arm.toml", leader=tmp_path / "leader.csv")
    host.follow()
    host.run(12.0)
    assert following(host)


def test_a_heavy_arm_is_lifted_and_held(lock_step: Any, tmp_path: Path) -> None:
    (tmp_path / "arm.toml").write_text(to_toml(HEAVY, {}), encoding="utf-8")
    host = lock_step(arm=tmp_path / "arm.toml")
    set_parameters(host, travel(HEAVY))
    host.follow()
    host.bench.leader.lead(np.array([0.0, -0.7, -0.4, 0.0]))
    host.run(2.0)
    lead(host, 0, 0.0, 4.0)
    assert following(host)
    assert abs(float(host.bench.angles[1])) < 0.2


def test_a_gripped_object_that_nobody_has_told_of_is_carried(lock_step: Any) -> None:
    host = lock_step()
    set_parameters(host, tuned() | travel(load_arm("default")))
    host.follow()
    lead(host, 0, 0.0, 2.0)
    host.bench.load_tip(GRIPPED_KG)
    host.run(5.0)
    assert following(host)
    assert np.abs(host.bench.angles).max() < 0.15


@pytest.mark.parametrize("known", [False, True])
def test_a_press_of_ten_seconds_is_held_gently_and_ends_when_the_leader_comes_back(lock_step: Any, known: bool) -> None:
    host = lock_step()
    set_parameters(host, tuned() | (travel(load_arm("default")) if known else {}))
    host.follow()
    lead(host, 1, 0.0, 2.0)
    host.bench.obstruct(1, 0.3)
    lead(host, 1, 0.7, 10.0)
    assert following(host)
    pressed = float(host.bench.angles[1])
    host.bench.obstruct(1, None)
    lead(host, 1, 0.0, 2.0)
    assert following(host)
    assert pressed == pytest.approx(0.3, abs=0.02)
    assert abs(float(host.bench.angles[1])) < 0.1


def test_a_hand_may_lean_on_the_follower_for_ten_seconds(lock_step: Any) -> None:
    host = lock_step()
    set_parameters(host, tuned() | travel(load_arm("default")))
    host.follow()
    lead(host, 0, 0.0, 2.0)
    host.bench.push(0, LEANS_V * load_arm("default").actuator(0).torque_per_volt)
    host.run(10.0)
    assert following(host)
    host.bench.push(0, 0.0)
    host.run(2.0)
    assert following(host)
    assert abs(float(host.bench.angles[0])) < 0.1


def test_a_joint_that_stays_blocked_is_stalled_after_its_time(lock_step: Any) -> None:
    joint, host = 1, lock_step()
    set_parameters(host, travel(load_arm("default")) | {"stall_time": 4 * STALLED_S})
    host.follow()
    lead(host, joint, 0.0, 2.0)
    host.bench.obstruct(joint, 0.1)
    lead(host, joint, 0.7, STALLED_S - 1.0)
    assert following(host)
    host.run(8.0)
    assert (host.status().fault, host.status().fault_where) == (Fault.STALLED, joint)
    assert not host.bench.motors_enabled


@pytest.mark.parametrize("joint", [1, 2])
def test_a_frozen_potentiometer_cannot_let_a_known_arm_run_away(lock_step: Any, joint: int) -> None:
    host = lock_step()
    set_parameters(host, tuned() | travel(load_arm("default")))
    host.follow()
    lead(host, joint, 0.0, 2.0)
    host.bench.inject(4 + joint, PotFault.FROZEN)
    host.bench.leader.lead(np.eye(4)[joint] * 0.4)
    farthest = 0.0
    for _ in range(300):
        host.run(0.01)
        farthest = max(farthest, abs(float(host.bench.angles[joint] - host.bench.leader.angles[joint])))
    assert farthest < 0.5
