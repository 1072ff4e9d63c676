"""A board's whole parameter table as TOML, in physical units: what `greywhale params backup` writes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from greywhale.base import sentences
from greywhale.base.errors import UserError, cut
from greywhale.base.formats import toml_file
from greywhale.base.formats.kinds import Kind, refuse_other_kind
from greywhale.base.formats.whole import write_text
from greywhale.files import controller
from greywhale.files.paper_tables import controller_path
from greywhale.protocol import schema
from greywhale.protocol.declared import Parameter
from greywhale.protocol.table import ParameterTable, physical


def save(path: str | Path, table: ParameterTable) -> None:
    """Write every parameter; `load` gives the same table back."""
    lines = [f"# greywhale parameters, CRC {table.crc:#06x}"]
    for group, parameters in _tables().items():
        lines += ["", f"[{group}]"] if group else []
        for parameter in parameters:
            unit = f"  # {parameter.unit}" if parameter.unit else ""
            name = parameter.name.rpartition(".")[2]
            lines.append(f"{name} = {physical(parameter, table.raw[parameter.index])}{unit}")
    write_text(path, "\n".join(lines) + "\n")


def load(path: str | Path) -> ParameterTable:
    """A whole table; every parameter must be there, in range, and nothing else.

    A file of an older layout gets the defaults of the parameters that this layout lacks, as a board does with its
    banks. Whoever changes a board takes `load_stated`.
    """
    return _table(load_stated(path), path)


def load_stated(path: str | Path) -> dict[str, int]:
    """The raw values that a file states, by name: all of its own layout, which may be older than this one."""
    data = toml_file.read(path)
    refuse_other_kind(data, str(path), Kind.PARAMETERS)
    found = _flat(data, path)
    unknown = [name for name in found if name not in schema.PARAMETER_BY_NAME]
    if unknown:
        advice = toml_file.advice(unknown[0], schema.PARAMETER_BY_NAME)
        key = toml_file.key_path(unknown[:1])
        raise UserError(f"{path}: {sentences.UNKNOWN_KEY.format(key=key, advice=advice)}.")
    layout = max((schema.PARAMETER_BY_NAME[name].since for name in found), default=1)
    stated = {
        parameter.name: _raw(parameter, found, path) for parameter in schema.PARAMETERS if parameter.since <= layout
    }
    _table(stated, path)  # what contradicts itself is refused here
    return stated


def not_in(stated: Mapping[str, int]) -> tuple[str, ...]:
    """The parameters that a file of an older layout does not state."""
    return tuple(one.name for one in schema.PARAMETERS if one.name not in stated)


def _raw(parameter: Parameter, found: Mapping[str, object], path: str | Path) -> int:
    if parameter.name not in found:
        raise UserError(f"{path}: {sentences.MISSING_PARAMETER.format(name=parameter.name)}")
    value = found[parameter.name]
    if isinstance(value, bool) or not isinstance(value, int | float):
        shown = cut(json.dumps(value, default=str))
        raise UserError(f"{path}: {sentences.NO_NUMBER.format(name=parameter.name, value=shown)}")
    try:
        return parameter.to_raw_as_given(value)
    except UserError as error:
        raise UserError(f"{path}: {error.message}") from None


def _table(stated: Mapping[str, int], path: str | Path) -> ParameterTable:
    try:
        return ParameterTable.defaults().with_raw(stated).with_name(str(path))
    except UserError as error:
        raise UserError(f"{path}: {error.message}") from None


def load_table(path: str | Path) -> ParameterTable:
    """A file of `greywhale params backup`, or a controller.toml (or its name) on top of the firmware's defaults."""
    data = toml_file.read(controller_path(path))
    refuse_other_kind(data, str(path), Kind.PARAMETERS, Kind.CONTROLLER)
    if isinstance(data.get("joint"), list):
        return controller.load(path).table().with_name(str(path))
    return load(path)


def _tables() -> dict[str, list[Parameter]]:
    """The parameters by their table in the file; those of none, "", come first, as TOML asks."""
    tables: dict[str, list[Parameter]] = {"": []}
    for parameter in schema.PARAMETERS:
        tables.setdefault(parameter.name.rpartition(".")[0], []).append(parameter)
    return tables


def _flat(data: dict[str, object], path: str | Path) -> dict[str, object]:
    flat: dict[str, object] = {}
    for key, value in data.items():
        if isinstance(value, dict):
            flat.update({f"{key}.{name}": item for name, item in value.items()})
        else:
            flat[key] = value
    return flat
