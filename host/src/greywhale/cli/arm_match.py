"""`greywhale arm match`: an arm file with the potentiometers of a calibrated board."""

from __future__ import annotations

from pathlib import Path
from typing import TypedDict

import click
import numpy as np

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.formats.whole import refuse_inputs, write_text
from greywhale.base.telling import Column, Row, Sentences, Step, Table, Telling
from greywhale.base.types import PerJoint
from greywhale.cli.output import FILE, json_option, option, overwrite_option, port_option, show
from greywhale.files.arm import load_arm
from greywhale.files.model import arm_toml
from greywhale.files.outputs import require_new


class Tracks(TypedDict):
    leader: PerJoint[float]
    follower: PerJoint[float]


class ArmMatchAnswer(TypedDict):
    written: str  # the file
    track_deg: Tracks


@click.command("match")
@click.argument("arm")
@port_option
@option("--out", "-o", type=FILE, default="matched.toml")
@overwrite_option
@json_option(ArmMatchAnswer)
def match(arm: str, port: str | None, out: Path, overwrite: bool, as_json: bool) -> None:
    """Write an arm file, or one that comes with greywhale, with the potentiometers as the board is calibrated.

    After `greywhale calibrate`, commission and tune refuse an arm file that says other tracks or zeros than the board.
    """
    # The other verbs for arm files run where these modules cannot.
    from greywhale.board.calibrate.match import with_board_pots
    from greywhale.board.device import Device
    from greywhale.board.upload import read_parameters
    from greywhale.protocol.ports import choose_port

    refuse_inputs(out, arm)
    require_new(overwrite, out)
    before = load_arm(arm)
    with Device(choose_port(port)) as device:
        table = read_parameters(device)
    found = with_board_pots(before, table)
    write_text(out, arm_toml(found, f"Made by greywhale arm match from {Path(arm).name}."))
    leader, follower = (
        [round(float(np.degrees(pot.track)), 2) for pot in bank.joint]
        for bank in (found.leader_pots, found.follower_pots)
    )
    answer: ArmMatchAnswer = {"written": str(out), "track_deg": {"leader": leader, "follower": follower}}
    rows = []
    for joint, name in enumerate(JOINT_NAMES):
        pair = (found.leader_pots.joint[joint], found.follower_pots.joint[joint])
        rows.append(Row((name, *(f"{np.degrees(pot.direction * pot.track):.1f}" for pot in pair))))
    columns = (Column(left=True), Column("leader", "degrees"), Column("follower", "degrees"))
    steps = (Step("commission", "Let the arm learn", {"arm_file": str(out)}),)
    show(as_json, answer, Telling((Sentences((f"{out} is written, with these tracks:",)), Table(columns, rows)), steps))
