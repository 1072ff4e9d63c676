"""The arms on which the paper is judged: the bench's own, one like the paper's, and some drawn around the white box."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from greywhale.arm import ArmParameters
from greywhale.base.formats.whole import write_text
from greywhale.files.arm import arm_names, load_arm
from greywhale.files.model import arm_toml
from greywhale_paper.work.drawn_arms import draw_arm

DEFAULT, STICKY = "default", "sticky_grey_box"
# The latter, led by another hand: no arm of its own, but other data sets.
OTHER_HAND = f"{STICKY}, another hand"


@cache
def arm_of(name: str) -> ArmParameters:
    """An arm by its name: one that comes with greywhale, or a drawn one."""
    if name in arm_names():
        return load_arm(name)
    return draw_arm(load_arm("white_box"), int(name.removeprefix("drawn ")))


def file_of(name: str, folder: Path) -> Path:
    """The same for a bench, which takes the name or a file; a drawn arm's is written into `folder`."""
    if name in arm_names():
        return Path(name)
    path = folder / f"{name}.arm.toml"
    write_text(path, arm_toml(arm_of(name), name))
    return path
