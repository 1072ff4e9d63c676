"""model.toml: the identified arm as a whole arm file, with a table that says how it was found and how certain it is."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from greywhale.arm import ArmParameters
from greywhale.base.formats import toml_text


def to_toml(arm: ArmParameters, identification: Mapping[str, Any]) -> str:
    head = "Written by greywhale identify. An arm file like any other, with one table more: [identification]."
    return "\n".join([arm_toml(arm, head), *toml_text.table("identification", identification), ""])


def sealed(arm: ArmParameters, identification: Mapping[str, Any]) -> dict[str, Any]:
    """The table [identification] with the seals of all tables: whoever reads the file sees whether it was edited."""
    return {**identification, "seal": seals(arm, identification)}


def seals(arm: ArmParameters, identification: Mapping[str, Any]) -> dict[str, str]:
    """A digest of each table of a model: of its values, whatever their order, and not of names and comments.

    Values that are as usual do not count, so that an arm file may get new keys with a usual value.
    """
    content = arm.model_dump(exclude={"name", "source", "identification"}, exclude_defaults=True)
    for joint in content["joint"]:
        joint.pop("name", None)
    content["identification"] = {key: value for key, value in identification.items() if key != "seal"}
    return {key: hashlib.sha256(_canonical(value).encode()).hexdigest()[:16] for key, value in content.items()}


def _canonical(value: object) -> str:
    """Equal values as equal text: keys in order, 2 and 2.0 alike."""
    if isinstance(value, Mapping):
        return "{" + ",".join(f"{json.dumps(key)}:{_canonical(value[key])}" for key in sorted(value)) + "}"
    if isinstance(value, list | tuple):
        return "[" + ",".join(map(_canonical, value)) + "]"
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return json.dumps(value)


def arm_toml(arm: ArmParameters, head: str) -> str:
    """The text of an arm.toml, below a comment."""
    data = arm.model_dump(exclude={"identification"})
    tables = {key: value for key, value in data.items() if isinstance(value, dict | list | tuple)}
    lines = [f"# {head}", ""]
    lines += [f"{key} = {toml_text.value(value)}" for key, value in data.items() if key not in tables]
    for key, value in tables.items():
        for one in value if isinstance(value, list | tuple) else [value]:
            header = f"[[{key}]]" if isinstance(value, list | tuple) else f"[{key}]"
            lines += ["", header, *(f"{name} = {toml_text.value(item)}" for name, item in one.items())]
    return "\n".join(lines) + "\n"
