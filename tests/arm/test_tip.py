"""The tip's place agrees with the compiled arm: a load there weighs and is heavy as its place says."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm.body import Body
from greywhale.arm.plants import plant_row
from greywhale.arm.tip import tip_of
from greywhale.files.arm import load_arm

STEP = 1e-6


def test_a_load_at_the_tip_turns_the_joints_as_its_place_says() -> None:
    arm = load_arm("default")
    loaded = arm.model_copy(update={"tip": arm.tip.model_copy(update={"mass": arm.tip.mass + 1.0})})
    q = np.random.default_rng(4).uniform(-1.2, 1.2, (20, 4))
    steps = STEP * np.eye(4)
    jacobian = np.stack([(tip_of(arm, q + step) - tip_of(arm, q - step)) / (2.0 * STEP) for step in steps], axis=2)
    bodies = [Body.of(plant_row(one)) for one in (arm, loaded)]
    weight = np.subtract(*(body.bias(q, np.zeros_like(q)) for body in reversed(bodies)))
    assert weight == pytest.approx(arm.gravity * jacobian[:, 1], abs=1e-7)  # y is up
    mass = np.subtract(*(body.mass_matrix(q) for body in reversed(bodies)))
    assert mass == pytest.approx(np.einsum("nki,nkj->nij", jacobian, jacobian), abs=1e-7)
