"""The model follows what drifts, from half a minute of work, and leaves alone what it cannot see."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greywhale.adapt.foresee import foresee, judged_of
from greywhale.adapt.limits import ADAPTATION_LIMITS
from greywhale.adapt.live_model import LiveModel
from greywhale.adapt.stretch import Stretch
from greywhale.arm import ArmParameters
from greywhale.files.arm import default_arm, load_arm
from greywhale.loop.controllers import controllers_of
from tests.adapt.conftest import TABLE
from tests.adapt.simulated import Work, with_gain
from tests.support.arms import make_arm
from tools.support.person_at_work import grown_friction

pytestmark = pytest.mark.slow
LIVE = LiveModel.of(default_arm())


def half_minute(arm: ArmParameters) -> list[Stretch]:
    work = Work(arm)
    return [stretch for _ in range(4) for stretch in work.piece(TABLE)]


def with_motors(**factors: float) -> ArmParameters:
    arm = default_arm()
    joints = tuple(
        joint.model_copy(
            update={
                "motor": joint.motor.model_copy(
                    update={name: factor * getattr(joint.motor, name) for name, factor in factors.items()}
                )
            }
        )
        for joint in arm.joint
    )
    return arm.model_copy(update={"joint": joints})


def with_supply(share: float) -> ArmParameters:
    """A battery that is nearly empty."""
    arm = default_arm()
    return arm.model_copy(update={"drive": arm.drive.model_copy(update={"supply": share * arm.drive.supply})})


def missed(live: LiveModel, stretches: list[Stretch]) -> float:
    """By how much the model misses the error of the whole arm, as a share."""
    found = foresee(live, TABLE, controllers_of(TABLE), stretches, live.plants[:1])[0]
    return float(abs(found.sum() / np.sum([one.error for one in judged_of(stretches)]) - 1.0))


@pytest.fixture(scope="module")
def grown() -> list[Stretch]:
    return half_minute(grown_friction(default_arm(), 1.4))


def test_friction_that_grew_is_found(grown: list[Stretch]) -> None:
    refitted = LIVE.refit(grown, TABLE, 1)
    friction = [ratio for name, ratio in refitted.changes().items() if name.endswith("coulomb")]
    assert friction == pytest.approx([1.4] * 4, rel=0.08)
    assert len(refitted.plants) == ADAPTATION_LIMITS.model.plants
    assert missed(LIVE, grown) > 0.15
    assert missed(refitted, grown) < 0.1


def test_an_unchanged_arm_stays_as_it_was() -> None:
    refitted = LIVE.refit(half_minute(default_arm()), TABLE, 1)
    friction = [ratio for name, ratio in refitted.changes().items() if name.endswith("coulomb")]
    assert friction == pytest.approx([1.0] * 4, rel=0.05)


@pytest.mark.parametrize(("joint", "gain"), [(0, 0.6), (1, 0.6), (2, 0.6), (3, 0.6), (0, 0.4), (3, 1.6)])
def test_a_potentiometer_that_turns_too_little_or_too_far_contradicts_its_voltages(joint: int, gain: float) -> None:
    clause = LIVE.refit(half_minute(with_gain(joint, gain)), TABLE, 1).contradiction
    assert clause.startswith(f"joint {joint}'s potentiometer turns ")
    told = float(clause.split()[4])
    assert told == pytest.approx(gain, abs=0.15)


@pytest.mark.parametrize(
    "arm",
    [
        grown_friction(default_arm(), 2.0),
        grown_friction(default_arm(), 0.5),
        with_motors(resistance=1.4, torque_constant=0.9),
        with_motors(viscous=3.0),
        with_supply(0.75),
        make_arm(tip={"mass": 0.8}),
        load_arm("worn"),
    ],
    ids=["stiff", "warm", "hot", "grease", "supply", "load", "worn"],
)
def test_an_arm_that_changes_at_work_contradicts_nothing(arm: ArmParameters) -> None:
    assert LIVE.refit(half_minute(arm), TABLE, 1).contradiction == ""


def test_a_joint_that_rests_keeps_its_numbers(grown: list[Stretch]) -> None:
    still = [replace(one, follower=one.follower * [1, 1, 1, 0], leader=one.leader * [1, 1, 1, 0]) for one in grown]
    changes = LIVE.refit(still, TABLE, 1).changes()
    assert changes["joint3.coulomb"] == pytest.approx(1.0, rel=1e-3)
    assert changes["joint0.coulomb"] == pytest.approx(1.4, rel=0.08)
