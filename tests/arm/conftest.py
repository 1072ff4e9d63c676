"""Arms for the tests: shipped ones with single values changed."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from typing import Any

import pytest

from greywhale.arm import ArmParameters
from greywhale.base.formats import toml_file
from greywhale.files.arm import load_arm

Change = Callable[..., ArmParameters]


def _merge(target: dict[str, Any], changes: Mapping[str, Any]) -> None:
    for key, value in changes.items():
        if isinstance(value, Mapping):
            _merge(target[key], value)
        else:
            target[key] = value


@pytest.fixture
def make_arm() -> Change:
    """The named arm, changed and validated: make_arm("default", gravity=0.0, every_joint={...}, joint_3={...})."""

    def make(name: str = "default", every_joint: Mapping[str, Any] | None = None, **changes: Any) -> ArmParameters:
        data = copy.deepcopy(load_arm(name).model_dump(mode="json"))
        for index in range(4):
            _merge(data["joint"][index], every_joint or {})
            _merge(data["joint"][index], changes.pop(f"joint_{index}", {}))
        _merge(data, changes)
        return toml_file.check(data, ArmParameters, name)

    return make


@pytest.fixture
def no_friction() -> dict[str, Any]:
    return {"friction": {"coulomb": 0.0, "breakaway": 0.0}}


@pytest.fixture
def rigid() -> dict[str, Any]:
    return {"gear": {"half_gap": 0.0, "stiffness": 0.0, "damping": 0.0, "drag": 0.0}}
