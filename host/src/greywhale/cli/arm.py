"""`greywhale arm`: arm files from answers, and from descriptions that other programs made."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import click
import numpy as np

from greywhale.arm.from_urdf import Imported, import_urdf
from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.formats.whole import refuse_inputs, write_text
from greywhale.base.telling import Sentences, Telling
from greywhale.base.types import PerJoint
from greywhale.cli.arm_match import match
from greywhale.cli.arm_new import new
from greywhale.cli.arm_table import Lifting, lifting, notes, table
from greywhale.cli.group import Group
from greywhale.cli.output import FILE, json_option, option, overwrite_option, require_supply, show
from greywhale.files.model import arm_toml
from greywhale.files.outputs import require_new


class ArmImportAnswer(Lifting):
    written: str  # the file
    signs: PerJoint[Annotated[int, ("enum", [1, -1])]]
    offsets_rad: PerJoint[float]
    remarks: list[str]  # what was left out or guessed


@click.group("arm", cls=Group)
def command() -> None:
    """Make an arm.toml, which describes geometry, masses, motors and stops of an arm."""


command.add_command(new)
command.add_command(match)


@command.command("import")
@click.argument("urdf", type=FILE)
@option("--out", "-o", type=FILE, default="arm.toml")
@option("--supply", default=15.0, help="The motors' supply, V.")
@overwrite_option
@json_option(ArmImportAnswer)
def import_(urdf: Path, out: Path, supply: float, overwrite: bool, as_json: bool) -> None:
    """Read a URDF: a yaw, two parallel pitches and a roll along the last link; a chain may end earlier.

    Frames and zero pose may be any; fixed joints are welded. What this arm or no body can have is refused by its name,
    and so are other units than m, kg, rad and N m where the numbers tell. It shows what the arm can lift and how fast
    it is. A URDF says nothing about gears, and its motors only by their effort and velocity limits, where 0 asks for a
    guess: `greywhale identify` finds what they really are.
    """
    require_supply(supply)
    refuse_inputs(out, urdf)
    require_new(overwrite, out)
    found = import_urdf(urdf, supply)
    write_text(out, arm_toml(found.arm, f"Made by greywhale arm import from {urdf.name}."))
    show(as_json, _facts(out, found), _telling(out, found))


def _facts(out: Path, found: Imported) -> ArmImportAnswer:
    return {
        "written": str(out),
        **lifting(found.summary),
        "signs": [int(sign) for sign in found.signs],
        "offsets_rad": [round(float(offset), 6) for offset in found.offsets],
        "remarks": list(found.remarks),
    }


def _telling(out: Path, found: Imported) -> Telling:
    lines = ["greywhale's angles, from those of the URDF (degrees):"]
    offsets = np.degrees(found.offsets)
    for joint, name in enumerate(JOINT_NAMES):
        if joint not in found.arm.joints_in_use:
            lines.append(f"  {name:16} not in use")
            continue
        sign, offset = found.signs[joint], offsets[joint]
        lines.append(f"  {name:16}{'-' if sign < 0 else ' '}q {offset:+.1f}")
    remarks = [f"Note: {remark}." for remark in found.remarks]
    told_notes = [Sentences(remarks, near=bool(notes(found.summary)))] if remarks else []
    parts = (*table(found.arm, found.summary), Sentences(lines), *notes(found.summary), *told_notes)
    return Telling((*parts, Sentences((f"{out} is written.",))))
