"""controller.toml: the fuzzy sets and gains of four joints, and how far a voltage moves each joint.

They are checked before any of them reaches a board. Reading a written file back gives the board's own numbers. The sets
are named as in the paper: NE [-1,-1,Ne_c,0], ZE [Ze_a,0,Ze_c], PE [0,Pe_b,1,1], and the same for the change of error
with Nce_c, Zce_a, Zce_c, Pce_b.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from operator import index
from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import Field

from greywhale.base import sentences
from greywhale.base.errors import UserError
from greywhale.base.formats import toml_file, toml_text
from greywhale.base.formats.kinds import Kind
from greywhale.base.formats.whole import write_text
from greywhale.files.names import suggesting
from greywhale.files.paper_tables import controller_names, controller_path
from greywhale.protocol import schema
from greywhale.protocol.declared import Parameter
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.table import CONTROLLER_COLUMNS, ParameterTable

# No flank of a fuzzy set may be narrower than this.
NARROWEST_FLANK = 0.01
GAINS = ("kp", "kd", "ki", "ku")
OF_A_JOINT = ("speed_per_volt", "time_constant", "breakaway_volts")
OF_THE_ARM = ("gravity_1", "gravity_12", "gravity_2")


def stored_as(key: str) -> tuple[str, float]:
    """The parameter that keeps a key of the file, without its joint, and how many of its units one of the file's is."""
    return ("ku_mv", 1000.0) if key == "ku" else (key.lower(), 1.0)


def _as_stored(key: str) -> Any:
    """The range of a key: that of its parameter."""
    name, scale = stored_as(key)
    parameter = schema.PARAMETER_BY_NAME.get(name) or schema.PARAMETER_BY_NAME[f"joint0.{name}"]
    least, most = (parameter.to_physical(raw) / scale for raw in (parameter.minimum, parameter.maximum))
    return Field(ge=least, le=most)


# Corners left and right of zero.
Left = Annotated[float, Field(ge=-1.0, le=-NARROWEST_FLANK)]
Right = Annotated[float, Field(ge=NARROWEST_FLANK, le=1.0)]
StallVolts = Annotated[float, _as_stored("stall_volts")]
_STALL = schema.PARAMETER_BY_NAME["stall_volts"]


class Sets(toml_file.Table):
    """The corners of one joint's fuzzy sets; every flank has zero at its other end."""

    Ne_c: Left
    Ze_a: Left
    Ze_c: Right
    Pe_b: Right
    Nce_c: Left
    Zce_a: Left
    Zce_c: Right
    Pce_b: Right


class JointController(toml_file.Table):
    """One joint: scaling factors kp (1/rad), kd (1/rad over 20 ms), ki (V/(rad s)), ku (V), and the sets.

    The change of error spans `ce_ticks` control periods; 1 where a file does not say.
    """

    kp: Annotated[float, _as_stored("kp")]
    kd: Annotated[float, _as_stored("kd")]
    ki: Annotated[float, _as_stored("ki")]
    ku: Annotated[float, _as_stored("ku")]
    ce_ticks: Annotated[int, _as_stored("ce_ticks")] = 1
    sets: Sets

    def parameters(self, joint: int = 0) -> list[tuple[str, Parameter, float]]:
        """Key in the file, parameter of the board and value in the parameter's unit."""
        values = self.model_dump(exclude={"sets"}) | self.sets.model_dump()
        stored = [(key, value, *stored_as(key)) for key, value in values.items()]
        return [
            (key, schema.PARAMETER_BY_NAME[f"joint{joint}.{name}"], scale * value) for key, value, name, scale in stored
        ]


class Travel(toml_file.Table):
    """The travel of each joint for a voltage: by these numbers the board holds a joint back that does not move.

    Of joint 0..3: `speed_per_volt` (rad/(s V)), `time_constant` (ms), `breakaway_volts` (V). Against gravity, with the
    arm level: `gravity_1`, `gravity_12` (V at joint 1), `gravity_2` (V at joint 2).
    """

    speed_per_volt: tuple[float, float, float, float]
    time_constant: tuple[float, float, float, float]
    breakaway_volts: tuple[float, float, float, float]
    gravity_1: float
    gravity_12: float
    gravity_2: float

    def parameters(self) -> list[tuple[Parameter, float]]:
        """Each parameter with its physical value."""
        names = {f"joint{joint}.{key}": getattr(self, key)[joint] for key in OF_A_JOINT for joint in range(JOINTS)}
        names |= {key: getattr(self, key) for key in OF_THE_ARM}
        return [(schema.PARAMETER_BY_NAME[name], value) for name, value in names.items()]


class Controller(toml_file.Table):
    """Controllers of joint 0..3, and where their numbers come from."""

    kinds: ClassVar[tuple[Kind, ...]] = (Kind.CONTROLLER,)

    source: str = ""
    stall_volts: StallVolts | None = None  # the board's own stays where the file says nothing
    travel: Travel | None = None  # the same
    joint: tuple[JointController, ...] = Field(min_length=JOINTS, max_length=JOINTS)
    tuning: dict[str, Any] | None = None  # how `greywhale tune` found it and what it expects; no board gets it

    def raw_values(self) -> dict[str, int]:
        """Parameter name -> raw value, for everything that a controller file says."""
        return self.other_values() | {
            parameter.name: parameter.to_raw(value)
            for number, joint in enumerate(self.joint)
            for _, parameter, value in joint.parameters(number)
        }

    def other_values(self) -> dict[str, int]:
        """The values of a table that are not in a controller."""
        stall = {} if self.stall_volts is None else {_STALL.name: _STALL.to_raw(self.stall_volts)}
        travel = [] if self.travel is None else self.travel.parameters()
        return stall | {parameter.name: parameter.to_raw(value) for parameter, value in travel}

    def table(self, rest: ParameterTable | None = None) -> ParameterTable:
        """A whole parameter table with these controllers. The other values are as given, or the firmware's defaults."""
        return (ParameterTable.defaults() if rest is None else rest).with_raw(self.raw_values())


def load(path: str | Path) -> Controller:
    """Read and check a controller file, or one that comes with greywhale by its name (`before_tuning`)."""
    with suggesting(path, controller_names()):
        controller = toml_file.load(controller_path(path), Controller)
    try:
        controller.raw_values()
    except UserError as error:
        raise UserError(f"{path}: {error.message}") from None
    for number, joint in enumerate(controller.joint):
        for key, parameter, value in joint.parameters(number):
            if value != 0.0 and parameter.to_raw(value) == 0:
                _, scale = stored_as(key)
                shown, least = f"{value / scale:g}", f"{parameter.lsb / scale:g}"
                words = sentences.TOO_SMALL_IN_FILE.format(key=f"joint[{number}].{key}", value=shown, least=least)
                raise UserError(f"{path}: {words}")
    return controller


def save(
    path: str | Path,
    rows: Iterable[Iterable[int]],
    source: str = "",
    *,
    header: Sequence[str] = (),
    notes: Sequence[str] = ("",) * JOINTS,
    travel: Mapping[str, int] | None = None,
    tuning: Mapping[str, Any] | None = None,
    stall_volts: float | None = None,
) -> None:
    """Write a controller file, or nothing at all where a board would refuse it.

    `rows` are raw as a board stores them: (4, 13), a joint's keys in the order of its parameters (sets 1/16384, gains
    1/65536, mV, control periods); an int32 array is one. `travel` are the raw parameters of Travel by
    their names. `load` gives the same raw values back. `header` are lines of comment on top, `notes` one for each
    joint.
    """
    lines = [*(f"# {line}".rstrip() for line in header), f"source = {toml_text.value(source)}"]
    lines += [] if stall_volts is None else [f"stall_volts = {toml_text.value(stall_volts)}"]
    for joint, (row, note) in enumerate(zip(rows, notes, strict=True)):
        values = _in_file(joint, row)
        lines += ["", f"[[joint]]  # {joint}" + (f": {note}" if note else "")]
        lines += [f"{key} = {toml_text.value(values[key])}" for key in (*GAINS, "ce_ticks")]
        lines += ["[joint.sets]", *(f"{key} = {toml_text.value(values[key])}" for key in Sets.model_fields)]
    if travel is not None:
        lines += ["", "[travel]  # how far a voltage moves each joint", *_travel_lines(travel)]
    if tuning is not None:
        lines += ["", *toml_text.table("tuning", tuning)]
    text = "\n".join(lines) + "\n"
    toml_file.loads(text, Controller, str(path))
    write_text(path, text)


def _travel_lines(raw: Mapping[str, int]) -> list[str]:
    def physical(name: str) -> float:
        return schema.PARAMETER_BY_NAME[name].to_physical(raw[name])

    values: dict[str, Any] = {key: [physical(f"joint{joint}.{key}") for joint in range(JOINTS)] for key in OF_A_JOINT}
    values |= {key: physical(key) for key in OF_THE_ARM}
    return [f"{key} = {toml_text.value(value)}" for key, value in values.items()]


def _in_file(joint: int, row: Iterable[int]) -> dict[str, float]:
    """A joint's raw values by their keys in the file, exactly as the board will use them."""
    raw = dict(zip(CONTROLLER_COLUMNS, row, strict=True))
    found = {}
    for key in (*Sets.model_fields, *GAINS, "ce_ticks"):
        name, scale = stored_as(key)
        parameter = schema.PARAMETER_BY_NAME[f"joint{joint}.{name}"]
        value = index(raw[name])
        parameter.check_raw(value)
        found[key] = value if key == "ce_ticks" else parameter.to_physical(value) / scale
    return found
