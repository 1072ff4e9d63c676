"""Arms as files: the ones that come with greywhale and the user's own."""

from __future__ import annotations

from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from greywhale.arm.parameters import ArmParameters
from greywhale.base.formats import toml_file
from greywhale.files.names import suggesting


def arm_names() -> list[str]:
    """The arms that come with greywhale: default, worn, two_joints, and the paper's white_box, grey_box and
    sticky_grey_box.
    """
    folder = _shipped()
    return sorted(entry.name.removesuffix(".toml") for entry in folder.iterdir() if entry.name.endswith(".toml"))


def load_arm(source: str | Path) -> ArmParameters:
    """Read an arm.toml, or one of `arm_names()` by its name; raises UserError naming file, key, value and reason."""
    if str(source) in arm_names():
        text = _shipped().joinpath(f"{source}.toml").read_text(encoding="utf-8")
        return toml_file.loads(text, ArmParameters, f"{source}.toml")
    with suggesting(source, arm_names()):
        return toml_file.load(source, ArmParameters)


def content_of(source: str | Path) -> bytes:
    """The bytes of the file that `load_arm` reads."""
    if str(source) in arm_names():
        return _shipped().joinpath(f"{source}.toml").read_bytes()
    return Path(source).read_bytes()


def default_arm() -> ArmParameters:
    """The believable real arm that the bench simulates unless told otherwise."""
    return load_arm("default")


def _shipped() -> Traversable:
    return resources.files("greywhale.arm").joinpath("data")
