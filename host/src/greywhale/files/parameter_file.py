"""A board's whole parameter table as TOML, in physical units: what `greywhale params backup` writes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from greywhale.errors import UserError
from greywhale.formats import toml_file
from greywhale.formats.whole import write_text
from greywhale.protocol import schema
from greywhale.protocol.declared import Parameter


def physical(parameter: Parameter, raw: int) -> float:
    """The value in the parameter's unit, rounded to the digits that still tell neighbouring raw values apart."""
    digits = max(0, 1 - math.floor(math.log10(parameter.lsb)))
    value = round(parameter.to_physical(raw), digits)
    return int(value) if parameter.lsb == 1.0 else value


def save(path: str | Path, values: Sequence[int]) -> None:
    """Write every parameter; `load` gives the same raw values back."""
    lines = [f"# greywhale parameters, CRC {schema.param_crc(values):#06x}"]
    table = ""
    for parameter in schema.PARAMETERS:
        group, _, name = parameter.name.rpartition(".")
        if group != table:
            table = group
            lines += ["", f"[{group}]"]
        unit = f"  # {parameter.unit}" if parameter.unit else ""
        lines.append(f"{name} = {physical(parameter, values[parameter.index])}{unit}")
    write_text(path, "\n".join(lines) + "\n")


def load(path: str | Path) -> tuple[int, ...]:
    """Raw values in index order; every parameter must be there, in range, and nothing else."""
    found = _flat(toml_file.read(path), path)
    unknown = [name for name in found if name not in schema.PARAMETER_BY_NAME]
    if unknown:
        raise UserError(f"{path}: unknown key {unknown[0]}; remove it or check its spelling.")
    values = []
    for parameter in schema.PARAMETERS:
        if parameter.name not in found:
            raise UserError(f"{path}: {parameter.name} is missing; a parameter file holds all of them.")
        value = found[parameter.name]
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise UserError(f"{path}: {parameter.name} is {value!r}, but it must be a number.")
        try:
            values.append(parameter.to_raw_as_given(value))
        except UserError as error:
            raise UserError(f"{path}: {error.message}") from None
    try:
        schema.check_parameters(values)
    except UserError as error:
        raise UserError(f"{path}: {error.message}") from None
    return tuple(values)


def _flat(data: dict[str, object], path: str | Path) -> dict[str, object]:
    flat: dict[str, object] = {}
    for key, value in data.items():
        if isinstance(value, dict):
            flat.update({f"{key}.{name}": item for name, item in value.items()})
        else:
            flat[key] = value
    return flat
