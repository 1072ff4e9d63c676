"""An identified plant as an arm file: what it changes, and what it leaves as the person wrote it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.arm.from_plant import arm_of, known_before
from greywhale.files.arm import load_arm
from greywhale.protocol.firmware import JOINTS
from greywhale.simulate import plant_row


def identified(arm: ArmParameters) -> ArmParameters:
    """The arm after an identification that found other values for all that it looks for."""
    plant = plant_row(arm) * 1.25 + 1e-4
    return arm_of(arm, plant, np.full(JOINTS, 0.02), "found", "a test", np.full(JOINTS, 3e-3))


def with_a_weak_supply(arm: ArmParameters) -> ArmParameters:
    data = arm.model_dump()
    data["drive"] |= {"resistance": 0.3, "supply_resistance": 0.2}
    return ArmParameters.model_validate(data, strict=False)


@pytest.mark.parametrize("name", ["default", "white_box", "two_joints"])
def test_what_is_known_before_is_what_an_identification_leaves(name: str) -> None:
    arm = with_a_weak_supply(load_arm(name))
    assert known_before(identified(arm)) == known_before(arm)


def leaves(data: Any, path: str = "") -> dict[str, Any]:
    if isinstance(data, dict):
        return {key: value for name, part in data.items() for key, value in leaves(part, f"{path}.{name}").items()}
    if isinstance(data, list | tuple):
        return {key: value for index, part in enumerate(data) for key, value in leaves(part, f"{path}.{index}").items()}
    return {path: data}


def test_all_that_an_identification_may_change_is_left_out() -> None:
    arm = with_a_weak_supply(load_arm("default"))
    before, after = leaves(arm.model_dump()), leaves(identified(arm).model_dump())
    changed = {path for path in before if before[path] != after.get(path)}
    assert {".drive.resistance", ".drive.supply_resistance", ".follower_pots.joint.0.lag"} <= changed
    assert not changed & {path for path in leaves(known_before(arm)) if not path.endswith(".name")}
