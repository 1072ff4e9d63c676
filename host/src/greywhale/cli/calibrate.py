"""`greywhale calibrate`: zero, scale and direction of every potentiometer, and the joints' limits, by hand."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, TypedDict

import click
import numpy as np
import numpy.typing as npt

from greywhale.base.errors import BadUsage, UserError, cut, require_between
from greywhale.base.telling import Column, Part, Row, Sentences, Step, Table, Telling
from greywhale.base.types import Crc, PerJoint
from greywhale.board.calibrate import Options, Result, calibrate
from greywhale.board.calibrate.history import keeping
from greywhale.board.calibrate.solve import Calibration
from greywhale.board.device import Device
from greywhale.board.pots import FULL_SCALE, POTS
from greywhale.board.upload import upload_set
from greywhale.cli import calibrations
from greywhale.cli.output import FILE, OnPort, json_option, option, overwrite_option, port_option, show
from greywhale.cli.person import Terminal
from greywhale.files import parameter_file
from greywhale.files.outputs import require_new
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.joints import parse, unused
from greywhale.protocol.ports import choose_port

FARTHEST_DEG = 359.0  # of a pose
_NAME = Column(width=11, left=True)
_DIRECTIONS = {True: "as the joint", False: "reversed"}
_TURNS = {1: "turns as it should", -1: "turned the wrong way, motor_sign is changed"}


class MotorFacts(TypedDict):
    joint: int
    sign: Annotated[int, ("enum", [1, -1])]  # -1: it turned the wrong way
    volts: float  # that moved it
    way_rad: float  # how far it moved


class CalibrateAnswer(OnPort):
    backup: str  # where the parameters from before are kept
    parameter_crc: Crc
    joints: list[int]  # in use
    changed: dict[str, int]  # parameter to raw value
    track_deg: Annotated[list[float], ("minItems", 8), ("maxItems", 8)]  # a potentiometer each; 0 where there is none
    limits_rad: PerJoint[Annotated[list[float], ("minItems", 2), ("maxItems", 2)]]  # lowest and highest angle
    motors: list[MotorFacts]  # empty with --no-motors
    reversed: list[str]  # potentiometers that read the other way
    remarks: list[str]
    apart_rad: PerJoint[float]  # how far the arms are apart in the last pose


@click.command("calibrate")
@port_option
@option("--joints", "in_use", metavar="LIST", default="0,1,2,3", help="The joints in use.")
@option("--first", metavar="A0,A1,A2,A3", default="0,0,0,0", help="The first pose, degrees.")
@option("--second", metavar="A0,A1,A2,A3", help="A second known pose, degrees; then the tracks' length is found.")
@option("--track", default=300.0, help="The tracks' length, degrees, without a second pose.")
@option("--backup", type=FILE, default="before-calibration.toml", help="Where the parameters from before are kept.")
@option("--no-motors", is_flag=True, help="Leave the motors alone; motor_sign stays as it is.")
@option("--yes", "-y", is_flag=True, help="Store the result without asking.")
@option("--history", is_flag=True, help="List earlier calibrations instead, as greywhale calibrations does.")
@overwrite_option
@json_option(CalibrateAnswer)
def command(
    port: str | None,
    in_use: str,
    first: str,
    second: str | None,
    track: float,
    backup: Path,
    no_motors: bool,
    yes: bool,
    history: bool,
    overwrite: bool,
    as_json: bool,
) -> None:
    """Find zero, scale and direction of every potentiometer, the joints' limits, and each motor's direction.

    You turn every joint to both ends, then hold both arms in a pose, motors off. Then each motor gets short weak
    pulses. Enter confirms each step, b goes back, a repeats, q ends; a script may write the lines. What is wired or
    mounted wrongly is named. The end shows the result, stores it if you say yes, and says how to undo it.

    An arm with fewer joints needs neither potentiometers nor motors for the others: --joints 0,1 asks for those two
    alone, and tells the board that the others are not in use.
    """
    if history:
        click.get_current_context().invoke(calibrations.command, back=None, port=port, as_json=as_json)
        return
    require_between("--track", track, "degrees", (180.0, 450.0))  # any potentiometer of one turn, and a little beyond
    joints = parse(in_use)
    poses = Options(
        _angles("--first", first),
        None if second is None else _angles("--second", second),
        float(np.radians(track)),
        motors=not no_motors,
        joints=joints,
    )
    require_new(overwrite, backup)
    with Device(choose_port(port)) as device:
        with _saying("Nothing was stored."), contextlib.closing(Terminal()) as person:
            result = calibrate(device, person, poses)
            found = _tell(result)
            if not yes:
                person.tell(Telling(found).text())
            if not (yes or person.agrees("Store this?")):
                raise UserError("you said no.")
            parameter_file.save(backup, result.before)
        with _saying(f"The board may have the new parameters; to undo: greywhale params restore {backup}"):
            with keeping(device.port, result.before, result.after, "calibrate"):
                upload_set(device, result.after)
    stored = Sentences(
        [
            f"Stored. To undo: greywhale params restore {backup}",
            "An arm file needs these potentiometers too: greywhale arm match arm.toml",
        ]
    )
    undo = Step("params restore", "Undo: take the parameters from before", {"file": str(backup)})
    steps = [Step("doctor", "Look at the set-up"), undo, Step("calibrations", "See earlier calibrations")]
    show(as_json, _facts(device.port, result, backup), Telling([*(found if yes else []), stored], steps))


@contextlib.contextmanager
def _saying(note: str) -> Iterator[None]:
    """Whatever ends this early, say what the board has."""
    try:
        yield
    except (UserError, KeyboardInterrupt) as error:
        error.add_note(note)
        raise


def _angles(option: str, text: str) -> npt.NDArray[np.float64]:
    try:
        degrees = np.array([float(part) for part in text.split(",")])
    except ValueError:
        degrees = np.empty(0)
    if degrees.shape != (JOINTS,) or not np.all(np.abs(degrees) <= FARTHEST_DEG):
        raise BadUsage(
            f"{option} is {cut(repr(text))}; give four angles in degrees within {FARTHEST_DEG:g}, such as 0,45,-30,20."
        )
    angles: npt.NDArray[np.float64] = np.radians(degrees)
    return angles


def _facts(port: str, result: Result, backup: Path) -> CalibrateAnswer:
    found = result.calibration
    return {
        "port": port,
        "backup": str(backup),
        "parameter_crc": f"0x{result.after.crc:04x}",
        "joints": list(found.joints),
        "changed": result.changes,
        "track_deg": [_track_deg(found, pot) if pot in found.pots else 0.0 for pot in range(len(POTS))],
        "limits_rad": [
            [round(float(end), 4) for end in found.limits[joint]] if joint in found.joints else [0.0, 0.0]
            for joint in range(JOINTS)
        ],
        "motors": [
            {"joint": one.joint, "sign": one.sign, "volts": round(one.volts, 3), "way_rad": round(one.way, 4)}
            for one in result.motors
        ],
        "reversed": list(result.reversed),
        "remarks": list(result.remarks),
        "apart_rad": [round(float(value), 5) for value in result.apart],
    }


def _track_deg(found: Calibration, pot: int) -> float:
    return round(float(np.degrees(abs(found.scale[pot]) * FULL_SCALE)), 2)


def _tell(result: Result) -> list[Part]:
    found = result.calibration
    tracks = [
        Row((POTS[pot], f"{found.zero[pot]:.1f}", f"{_track_deg(found, pot):.1f}", _DIRECTIONS[found.scale[pot] > 0]))
        for pot in found.pots
    ]
    limits = []
    for joint in found.joints:
        low, high = np.degrees(found.limits[joint])
        limits.append(Row((f"joint {joint}", f"{low:.0f} to {high:.0f}", f"{1e3 * result.apart[joint]:.1f}")))
    limits += [Row((f"joint {joint}", "not in use")) for joint in unused(found.joints)]
    motors = [Row((f"motor {one.joint}", f"{_TURNS[one.sign]} ({one.volts:.1f} V)")) for one in result.motors]
    return [
        Table(
            (_NAME, Column("zero", "counts", 14), Column("track", "degrees", 15), Column("direction", left=True)),
            tracks,
        ),
        Table((_NAME, Column("limits", "degrees", 18), Column("the arms differ by", "mrad", 26)), limits),
        *([Table((_NAME, Column(left=True)), motors)] if motors else []),
        Sentences(result.remarks, grave=True),
    ]
