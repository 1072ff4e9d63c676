"""Finds the controller with which a log was recorded: by the CRC in the log's header, or in that header itself. It
never assumes one.
"""

from __future__ import annotations

from collections.abc import Sequence

from greywhale.base.errors import UserError
from greywhale.files.log import Log
from greywhale.protocol.table import ParameterTable, find_board


def table_of(log: Log, given: Sequence[ParameterTable]) -> ParameterTable | None:
    """The table of this log, on its board, or None where neither the log nor the user gives it."""
    found = _found(log, given)
    if found is None or log.origin.board is None:
        return found
    return found.for_board(find_board(log.origin.board))


def _found(log: Log, given: Sequence[ParameterTable]) -> ParameterTable | None:
    crc = log.origin.param_crc
    if crc is None:
        return log.origin.table or _only_one(log, given)
    for table in (*given, ParameterTable.defaults()):
        if table.crc == crc:
            return table
    if log.origin.table is not None:
        return log.origin.table
    if not given:
        return None
    known = ", ".join(f"{table.name} 0x{table.crc:04x}" for table in given)
    raise UserError(
        f"{log.name}: it was recorded with parameter set 0x{crc:04x}, but there are only {known}; give the set of that "
        "recording (greywhale params backup) with --controller, or none at all."
    )


def _only_one(log: Log, given: Sequence[ParameterTable]) -> ParameterTable | None:
    if len(given) > 1:
        raise UserError(f"{log.name}: its header has no parameter_crc, so only one --controller may be given.")
    if not given:
        return None
    period = log.origin.period_ms
    stated = given[0].period_ms
    if period is not None and period != stated:
        raise UserError(
            f"{log.name}: its control period is {period} ms, but {given[0].name} has {stated} ms; "
            "give the controller of that recording."
        )
    return given[0]
