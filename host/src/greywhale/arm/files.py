"""Arms as files: the ones that come with greywhale and the user's own."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

from greywhale.arm.parameters import ArmParameters
from greywhale.config import toml_file

_DATA = "data"


def arm_names() -> list[str]:
    """The arms that come with greywhale: default, and the paper's white_box and grey_box."""
    folder = resources.files(__package__).joinpath(_DATA)
    return sorted(entry.name.removesuffix(".toml") for entry in folder.iterdir() if entry.name.endswith(".toml"))


def load_arm(source: str | Path) -> ArmParameters:
    """Read an arm.toml, or one of `arm_names()` by its name; raises UserError naming file, key, value and reason."""
    if source in arm_names():
        text = resources.files(__package__).joinpath(_DATA, f"{source}.toml").read_text(encoding="utf-8")
        return toml_file.loads(text, ArmParameters, f"{source}.toml")
    return toml_file.load(source, ArmParameters)


def default_arm() -> ArmParameters:
    """The believable real arm that the bench simulates unless told otherwise."""
    return load_arm("default")
