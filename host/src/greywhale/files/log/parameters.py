"""The board's parameter table inside a log's header: the set that ran, so that a log needs no backup beside it.

A line for each group, `parameters` for those without one and `parameters.joint0` for the others, with values in the
units of `greywhale params`. The CRC in the header proves the set.
"""

from __future__ import annotations

from collections.abc import Mapping

from greywhale.base.errors import UserError, cut
from greywhale.base.formats.csv_file import number
from greywhale.protocol import schema
from greywhale.protocol.table import ParameterTable, find_board, physical

KEY = "parameters"


def lines_of(table: ParameterTable) -> list[str]:
    """A table as lines of a header, without their `#`."""
    groups: dict[str, list[str]] = {}
    for parameter in schema.PARAMETERS:
        group, _, name = parameter.name.rpartition(".")
        value = physical(parameter, table.raw[parameter.index])
        groups.setdefault(f"{KEY}.{group}" if group else KEY, []).append(f"{name}={value}")
    return [f"{key}: {' '.join(settings)}" for key, settings in groups.items()]


def table_in(facts: Mapping[str, str], name: str, crc: int | None, board: str | None) -> ParameterTable | None:
    """The table in the facts of the header of the log `name`, or None where there is none.

    A log from before a parameter was added has its default, as a board has that keeps an older set; then the CRC
    proves nothing.
    """
    found = {f"{group}{key}": text for group, settings in _groups(facts) for key, text in _pairs(settings, name)}
    if not found:
        return None
    unknown = [key for key in found if key not in schema.PARAMETER_BY_NAME]
    if unknown:
        raise UserError(
            f"{name}: the header has the parameter {cut(unknown[0])}, which this greywhale does not know; "
            "read the log with the version that wrote it."
        )
    try:
        raw = [
            parameter.to_raw_as_given(number(found[parameter.name])) if parameter.name in found else parameter.default
            for parameter in schema.PARAMETERS
        ]
        table = ParameterTable(tuple(raw), find_board(board), name)
    except UserError as error:
        raise UserError(f"{name}: a parameter in the header is wrong: {error.message}") from None
    except ValueError as error:
        raise UserError(f"{name}: a parameter in the header is no number: {cut(str(error))}.") from None
    if crc is not None and len(found) == len(schema.PARAMETERS) and table.crc != crc:
        raise UserError(
            f"{name}: the parameters in the header have CRC 0x{table.crc:04x}, but its parameter_crc is 0x{crc:04x}; "
            "the header was changed. Take the log as it was recorded, or delete the lines with the parameters and with "
            "the check."
        )
    return table


def _groups(facts: Mapping[str, str]) -> list[tuple[str, str]]:
    """The prefix of the names in each line with parameters, "" or "joint0.", and its settings."""
    return [
        (key.removeprefix(KEY).removeprefix(".") + "." * (key != KEY), text)
        for key, text in facts.items()
        if key == KEY or key.startswith(f"{KEY}.")
    ]


def _pairs(settings: str, name: str) -> list[tuple[str, str]]:
    pairs = []
    for setting in settings.split():
        key, equals, value = setting.partition("=")
        if not equals:
            raise UserError(f"{name}: {cut(repr(setting))} in the header is not NAME=VALUE, as parameters are.")
        pairs.append((key, value))
    return pairs
