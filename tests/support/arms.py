"""Arms for the tests: shipped ones, and others, with single values changed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from greywhale.arm import ArmParameters
from greywhale.base.formats import toml_file
from greywhale.files.arm import load_arm


def make_arm(
    of: ArmParameters | str = "default", every_joint: Mapping[str, Any] | None = None, **changes: Any
) -> ArmParameters:
    """The arm, changed and validated: make_arm("worn", gravity=0.0, every_joint={...}, joint_3={...}). What stands in a
    list is changed by its number, or in every place: follower_pots={"joint": {2: {...}}} or {"joint": {...}}.
    """
    data = (load_arm(of) if isinstance(of, str) else of).model_dump(mode="json")
    _merge(data["joint"], every_joint or {})
    for index in range(4):
        _merge(data["joint"][index], changes.pop(f"joint_{index}", {}))
    _merge(data, changes)
    return toml_file.check(data, ArmParameters, "an arm")


def _merge(target: Any, changes: Mapping[Any, Any]) -> None:
    for key, value in changes.items():
        if isinstance(target, list) and not isinstance(key, int):
            for one in target:
                _merge(one, {key: value})
        elif isinstance(value, Mapping):
            _merge(target[key], value)
        else:
            target[key] = value


def with_joints(used: tuple[int, ...], of: ArmParameters | str = "default", **changes: Any) -> ArmParameters:
    """The arm with these joints alone in use."""
    fixed: dict[str, Any] = {f"joint_{joint}": {"fixed": joint not in used} for joint in range(4)}
    return make_arm(of, **fixed, **changes)
