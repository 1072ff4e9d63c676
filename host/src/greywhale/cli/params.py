"""`greywhale params`: a board's parameter table, one by one or as a file."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TypedDict

import click

from greywhale.base.errors import BadUsage, cut
from greywhale.base.formats.units import read_number, unit_of
from greywhale.base.types import Crc
from greywhale.board.device import Device
from greywhale.board.upload import UploadFacts, change_parameters, read_parameters
from greywhale.cli import completion
from greywhale.cli.group import Group
from greywhale.cli.output import FILE, OnPort, json_option, overwrite_option, port_option, progress, show
from greywhale.files import parameter_file
from greywhale.files.names import did_you_mean
from greywhale.files.outputs import require_new
from greywhale.protocol import schema
from greywhale.protocol.declared import Parameter
from greywhale.protocol.ports import choose_port
from greywhale.protocol.table import physical


class GetAnswer(OnPort):
    parameters: dict[str, float]  # name to value, in the parameter's unit


class SetAnswer(OnPort, UploadFacts):
    stored: dict[str, float]  # name to value as stored, in the parameter's unit


class BackupAnswer(OnPort):
    file: str
    parameter_crc: Crc


class RestoreAnswer(OnPort, UploadFacts):
    pass


class Difference(TypedDict):
    board: float
    file: float


class DiffAnswer(OnPort):
    file: str
    differences: dict[str, Difference]  # name to both values, in the parameter's unit


@click.group("params", cls=Group)
def command() -> None:
    """Read and change a board's parameter table.

    Parameters have names such as joint0.kp, leader2.zero or supply_mv, and values in the unit that `get` shows.
    """


@command.command("get")
@click.argument("names", metavar="[NAME]...", nargs=-1, shell_complete=completion.parameters)
@port_option
@json_option(GetAnswer)
def get(names: tuple[str, ...], port: str | None, as_json: bool) -> None:
    """Show parameters; without names, all of them.

    The beginning of names stands for all that begin so: joint0, leader, unrest.
    """
    wanted = [one for name in names for one in _beginning_with(name)] or list(schema.PARAMETERS)
    with Device(choose_port(port)) as device, progress(brief=True) as report:
        table = read_parameters(device, report)
    facts = {parameter.name: physical(parameter, table[parameter.name]) for parameter in wanted}
    lines = [f"{name:<16} {value:>12g} {schema.PARAMETER_BY_NAME[name].unit}" for name, value in facts.items()]
    answer: GetAnswer = {"port": device.port, "parameters": facts}
    show(as_json, answer, "\n".join(line.rstrip() for line in lines))


@command.command("set")
@click.argument("settings", metavar="NAME=VALUE...", nargs=-1, required=True, shell_complete=completion.settings)
@port_option
@json_option(SetAnswer)
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
        done = change_parameters(device, changes, report)
    stored = {name: physical(schema.PARAMETER_BY_NAME[name], raw) for name, raw in changes.items()}
    lines = [f"  {name} = {value:.9g} {schema.PARAMETER_BY_NAME[name].unit}".rstrip() for name, value in stored.items()]
    answer: SetAnswer = {"port": device.port, **done.as_dict(), "stored": stored}
    show(as_json, answer, "\n".join([_changed(device.port, done.changed), "The board now runs and keeps:", *lines]))


@command.command("backup")
@click.argument("file", type=FILE)
@port_option
@overwrite_option
@json_option(BackupAnswer)
def backup(file: Path, port: str | None, overwrite: bool, as_json: bool) -> None:
    """Write all parameters of a board into a TOML file."""
    require_new(overwrite, file)
    with Device(choose_port(port)) as device, progress(brief=True) as report:
        table = read_parameters(device, report)
    parameter_file.save(file, table)
    answer: BackupAnswer = {"port": device.port, "file": str(file), "parameter_crc": f"0x{table.crc:04x}"}
    show(as_json, answer, f"{file}: {len(table.raw)} parameters, CRC {table.crc:#06x}.")


@command.command("restore")
@click.argument("file", type=FILE)
@port_option
@json_option(RestoreAnswer)
def restore(file: Path, port: str | None, as_json: bool) -> None:
    """Run and store the parameters of a backup."""
    wanted = parameter_file.load(file)
    with Device(choose_port(port)) as device, progress(brief=True) as report:
        done = change_parameters(device, wanted.by_name(), report)
    answer: RestoreAnswer = {"port": device.port, **done.as_dict()}
    show(as_json, answer, _changed(device.port, done.changed))


@command.command("diff")
@click.argument("file", type=FILE)
@port_option
@json_option(DiffAnswer)
def diff(file: Path, port: str | None, as_json: bool) -> None:
    """Show where a board differs from a backup."""
    wanted = parameter_file.load(file)
    with Device(choose_port(port)) as device, progress(brief=True) as report:
        running = read_parameters(device, report)
    differences: dict[str, Difference] = {
        parameter.name: {
            "board": physical(parameter, running[parameter.name]),
            "file": physical(parameter, wanted[parameter.name]),
        }
        for parameter in schema.PARAMETERS
        if running[parameter.name] != wanted[parameter.name]
    }
    lines = [f"{name:<16} board {both['board']:g}, file {both['file']:g}" for name, both in differences.items()]
    answer: DiffAnswer = {"port": device.port, "file": str(file), "differences": differences}
    show(as_json, answer, "\n".join(lines) or f"{device.port} and {file} hold the same parameters.")


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
