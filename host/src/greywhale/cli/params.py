"""`greywhale params`: a board's parameter table, one by one or as a file."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypedDict

import click

from greywhale.base.errors import BadUsage, UserError, counted, cut
from greywhale.base.formats.units import read_number, unit_of
from greywhale.base.telling import Column, Part, Row, Sentences, Step, Table, Telling, told
from greywhale.base.types import Crc, Progress
from greywhale.board.calibrate.history import keeping
from greywhale.board.device import Device
from greywhale.board.upload import Uploaded, UploadFacts, change_parameters, read_parameters
from greywhale.cli import completion
from greywhale.cli.group import Group
from greywhale.cli.output import FILE, OnPort, json_option, option, overwrite_option, port_option, progress, show, tell
from greywhale.cli.person import Terminal
from greywhale.files import parameter_file
from greywhale.files.names import did_you_mean
from greywhale.files.outputs import require_new
from greywhale.protocol import schema
from greywhale.protocol.declared import Parameter
from greywhale.protocol.ports import choose_port
from greywhale.protocol.table import ParameterTable, physical

DEFAULTS = "defaults"
MISSING = ("board", DEFAULTS)  # what parameters become that a file does not state
MOST_NAMED = 8  # parameters in a sentence
_NAME, _UNIT = Column("parameter", width=16, left=True), Column("unit", width=1, left=True)
_VALUES = (Column(width=16, left=True), Column(width=12), Column(width=1, left=True))
_BESIDE = (_NAME, Column("board", width=12), Column("file", width=12), _UNIT)


class ParamsGetAnswer(OnPort):
    parameters: dict[str, float]  # name to value, in the parameter's unit


class ParamsSetAnswer(OnPort, UploadFacts):
    stored: dict[str, float]  # name to value as stored, in the parameter's unit


class ParamsBackupAnswer(OnPort):
    file: str
    parameter_crc: Crc


class ParamsRestoreAnswer(OnPort, UploadFacts):
    not_in_file: list[str]  # parameters that the file, as an older one, does not state
    kept: list[str]  # those of them that keep a value of the board other than the default


class Difference(TypedDict):
    board: float
    file: float | None  # null: an older file does not state it, and the board has another value than the default


class ParamsDiffAnswer(OnPort):
    file: str
    differences: dict[str, Difference]  # name to both values, in the parameter's unit
    not_in_file: list[str]  # parameters that the file, as an older one, does not state


@click.group("params", cls=Group)
def command() -> None:
    """Read and change a board's parameter table.

    Parameters have names such as joint0.kp, leader2.zero or supply_mv, and values in the unit that `get` shows.
    """


@command.command("get")
@click.argument("names", metavar="[NAME]...", nargs=-1, shell_complete=completion.parameters)
@port_option
@json_option(ParamsGetAnswer)
def get(names: tuple[str, ...], port: str | None, as_json: bool) -> None:
    """Show parameters; without names, all of them.

    The beginning of names stands for all that begin so: joint0, leader, unrest.
    """
    wanted = [one for name in names for one in _beginning_with(name)] or list(schema.PARAMETERS)
    with Device(choose_port(port)) as device, progress(brief=True) as report:
        table = read_parameters(device, report)
    facts = {parameter.name: physical(parameter, table[parameter.name]) for parameter in wanted}
    rows = [Row((name, f"{value:g}", schema.PARAMETER_BY_NAME[name].unit)) for name, value in facts.items()]
    answer: ParamsGetAnswer = {"port": device.port, "parameters": facts}
    show(as_json, answer, Telling((Table(_VALUES, rows),)))


@command.command("set")
@click.argument("settings", metavar="NAME=VALUE...", nargs=-1, required=True, shell_complete=completion.settings)
@port_option
@json_option(ParamsSetAnswer)
def set_(settings: tuple[str, ...], port: str | None, as_json: bool) -> None:
    """Change parameters, all together: run them and store them.

    A value may have its unit, or another of the same kind: supply_mv=12V, joint0.limit_min=-90deg.
    """
    changes: dict[str, int] = {}
    for name, raw in map(_setting, settings):
        if name in changes:
            raise BadUsage(f"{name} is given twice; give it once.")
        changes[name] = raw
    with Device(choose_port(port)) as device, progress(brief=True) as report:
        done = _change(device, read_parameters(device, report), changes, "set", report)
    stored = {name: physical(schema.PARAMETER_BY_NAME[name], raw) for name, raw in changes.items()}
    lines = [f"  {name} = {value:.9g} {schema.PARAMETER_BY_NAME[name].unit}".rstrip() for name, value in stored.items()]
    answer: ParamsSetAnswer = {"port": device.port, **done.as_dict(), "stored": stored}
    show(as_json, answer, "\n".join([_changed(device.port, done.changed), "The board now runs and keeps:", *lines]))


@command.command("backup")
@click.argument("file", type=FILE)
@port_option
@overwrite_option
@json_option(ParamsBackupAnswer)
def backup(file: Path, port: str | None, overwrite: bool, as_json: bool) -> None:
    """Write all parameters of a board into a TOML file."""
    require_new(overwrite, file)
    with Device(choose_port(port)) as device, progress(brief=True) as report:
        table = read_parameters(device, report)
    parameter_file.save(file, table)
    answer: ParamsBackupAnswer = {"port": device.port, "file": str(file), "parameter_crc": f"0x{table.crc:04x}"}
    compare = Step("params diff", "Compare the board with this file", {"file": str(file)})
    show(as_json, answer, told(f"{file}: {len(table.raw)} parameters, CRC {table.crc:#06x}.", steps=[compare]))


@command.command("restore")
@click.argument("file", type=FILE)
@option(
    "--missing",
    type=click.Choice(MISSING),
    help="What becomes of parameters that an older file does not state: they keep the board's values, or take the "
    "defaults.",
)
@port_option
@json_option(ParamsRestoreAnswer)
def restore(file: Path, missing: str | None, port: str | None, as_json: bool) -> None:
    """Run and store the parameters of a backup.

    A backup of an older greywhale does not state newer parameters. They keep the board's values; a terminal is asked
    first where these are not the defaults.
    """
    wanted = parameter_file.load_stated(file)
    silent = parameter_file.not_in(wanted)
    with Device(choose_port(port)) as device:
        with progress(brief=True) as report:
            running = read_parameters(device, report)
        kept = [] if missing == DEFAULTS else _not_default(running, silent)
        if kept and missing is None and not as_json and sys.stdin.isatty() and not _agrees_to_keep(file, running, kept):
            raise UserError(
                f"{device.port}: nothing was restored; --missing defaults takes the defaults of what {file} lacks."
            )
        if missing == DEFAULTS:
            wanted |= {name: schema.PARAMETER_BY_NAME[name].default for name in silent}
        with progress(brief=True) as report:
            done = _change(device, running, wanted, "restore", report)
    answer: ParamsRestoreAnswer = {"port": device.port, **done.as_dict(), "not_in_file": list(silent), "kept": kept}
    lines = [_changed(device.port, done.changed)]
    if kept:
        lines.append(
            f"{file} is older and does not state these; they keep the board's values: {_named(running, kept)}."
        )
    show(as_json, answer, told(*lines, steps=[Step("doctor", "Look at the set-up")]))


@command.command("diff")
@click.argument("file", type=FILE)
@port_option
@json_option(ParamsDiffAnswer)
def diff(file: Path, port: str | None, as_json: bool) -> None:
    """Show where a board differs from a backup."""
    wanted = parameter_file.load_stated(file)
    silent = parameter_file.not_in(wanted)
    with Device(choose_port(port)) as device, progress(brief=True) as report:
        running = read_parameters(device, report)
    differ = {name for name, raw in wanted.items() if running[name] != raw} | set(_not_default(running, silent))
    differences: dict[str, Difference] = {
        one.name: {
            "board": physical(one, running[one.name]),
            "file": physical(one, wanted[one.name]) if one.name in wanted else None,
        }
        for one in schema.PARAMETERS
        if one.name in differ
    }
    lines = [] if differences else [f"{device.port} and {file} hold the same parameters."]
    if silent:
        lines.append(
            f"{file} is older and does not state {counted(len(silent), 'parameter')}; the others are compared."
        )
    answer: ParamsDiffAnswer = {
        "port": device.port,
        "file": str(file),
        "differences": differences,
        "not_in_file": list(silent),
    }
    rows = [_difference(name, both) for name, both in differences.items()]
    parts: list[Part] = [Table(_BESIDE, rows)] if rows else []
    parts.append(Sentences(lines, near=True))
    restore = Step("params restore", "Give the board what the file says", {"file": str(file)})
    show(as_json, answer, Telling(parts, [restore] if rows else []))


def _change(
    device: Device, running: ParameterTable, changes: Mapping[str, int], why: str, report: Progress
) -> Uploaded:
    """Change parameters; a calibration that this changes is kept."""
    with keeping(device.port, running, running.with_raw(changes), why):
        return change_parameters(device, changes, report, running)


def _difference(name: str, both: Difference) -> Row:
    file = "not there" if both["file"] is None else f"{both['file']:g}"
    return Row((name, f"{both['board']:g}", file, schema.PARAMETER_BY_NAME[name].unit))


def _not_default(table: ParameterTable, names: Sequence[str]) -> list[str]:
    return [name for name in names if table[name] != schema.PARAMETER_BY_NAME[name].default]


def _agrees_to_keep(file: Path, table: ParameterTable, names: Sequence[str]) -> bool:
    tell(f"{file} is older and does not state {_named(table, names)}.")
    with contextlib.closing(Terminal()) as person:
        return person.agrees("Keep these values of the board?")


def _named(table: ParameterTable, names: Sequence[str]) -> str:
    """The first few parameters with their values."""
    each = [f"{name} = {physical(schema.PARAMETER_BY_NAME[name], table[name]):g}" for name in names]
    more = f" and {len(each) - MOST_NAMED} more" if len(each) > MOST_NAMED else ""
    return f"{', '.join(each[:MOST_NAMED])}{more}"


def _beginning_with(name: str) -> list[Parameter]:
    """The parameter of this name, or all those whose names begin so."""
    if name in schema.PARAMETER_BY_NAME:
        return [schema.PARAMETER_BY_NAME[name]]
    return [one for one in schema.PARAMETERS if name and one.name.startswith(name)] or [_parameter(name)]


def _parameter(name: str) -> Parameter:
    try:
        return schema.PARAMETER_BY_NAME[name]
    except KeyError:
        meant = did_you_mean(name, schema.PARAMETER_BY_NAME)
        raise BadUsage(
            f"there is no parameter {cut(json.dumps(name))}; `greywhale params get` shows all names.{meant}"
        ) from None


def _setting(text: str) -> tuple[str, int]:
    name, equals, value = text.partition("=")
    if not equals:
        raise BadUsage(f"{cut(json.dumps(text))} is not NAME=VALUE, such as joint0.kp=0.5.")
    parameter = _parameter(name.strip())
    try:
        number = read_number(value, unit_of(parameter.unit))
    except ValueError as error:
        raise BadUsage(f"{name} is {cut(json.dumps(value))}: {error}.") from None
    return parameter.name, parameter.to_raw_as_given(number)


def _changed(port: str, names: Sequence[str]) -> str:
    return f"{port}: changed and stored {', '.join(names)}." if names else f"{port}: nothing had to change."
