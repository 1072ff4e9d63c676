"""The model follows what drifts, from half a minute of work, and leaves alone what it cannot see."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greywhale.adapt.foresee import foresee, judged_of
from greywhale.adapt.live_model import PLANTS, LiveModel
from greywhale.adapt.stretch import Stretch
from greywhale.arm import ArmParameters
from greywhale.files.arm import default_arm
from greywhale.simulate.controllers import controllers_of
from tests.adapt.conftest import TABLE
from tests.adapt.simulated import Work
from tools.support.worker import grown_friction

pytestmark = pytest.mark.slow
LIVE = LiveModel.of(default_arm())


def half_minute(arm: ArmParameters) -> list[Stretch]:
    work = Work(arm)
    return [stretch for _ in range(4) for stretch in work.piece(TABLE)]


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
    assert len(refitted.plants) == PLANTS
    assert missed(LIVE, grown) > 0.15
    assert missed(refitted, grown) < 0.1


def test_an_unchanged_arm_stays_as_it_was() -> None:
    refitted = LIVE.refit(half_minute(default_arm()), TABLE, 1)
    friction = [ratio for name, ratio in refitted.changes().items() if name.endswith("coulomb")]
    assert friction == pytest.approx([1.0] * 4, rel=0.05)


def test_a_joint_that_rests_keeps_its_numbers(grown: list[Stretch]) -> None:
    still = [replace(one, follower=one.follower * [1, 1, 1, 0], leader=one.leader * [1, 1, 1, 0]) for one in grown]
    changes = LIVE.refit(still, TABLE, 1).changes()
    assert changes["joint3.coulomb"] == pytest.approx(1.0, rel=1e-3)
    assert changes["joint0.coulomb"] == pytest.approx(1.4, rel=0.08)
