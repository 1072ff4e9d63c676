"""Which controller a log was recorded with: found by the CRC in its header, never assumed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from greywhale.errors import UserError
from greywhale.files import controller, parameter_file
from greywhale.files.log import Log
from greywhale.formats import toml_file
from greywhale.protocol import schema


@dataclass(frozen=True)
class Table:
    """A whole parameter table, raw, and where it comes from."""

    name: str
    values: tuple[int, ...]

    @property
    def crc(self) -> int:
        return schema.param_crc(self.values)

    def changed(self) -> dict[str, int]:
        """By name, raw, what differs from the firmware's defaults."""
        both = zip(schema.PARAMETERS, self.values, strict=True)
        return {one.name: value for one, value in both if value != schema.DEFAULTS[one.index]}


DEFAULTS = Table("the firmware's defaults", tuple(schema.DEFAULTS))


def load_table(path: str | Path) -> Table:
    """A file of `greywhale params backup`, or a controller.toml on top of the firmware's defaults."""
    if isinstance(toml_file.read(path).get("joint"), list):
        raw = controller.load(path).raw_values()
        return Table(str(path), tuple(raw.get(index, value) for index, value in enumerate(schema.DEFAULTS)))
    return Table(str(path), parameter_file.load(path))


def table_of(log: Log, given: Sequence[Table]) -> Table | None:
    """The table of this log, or None where the log does not say and the user did not."""
    crc = log.origin.param_crc
    if crc is None:
        return _only_one(log, given)
    for table in (*given, DEFAULTS):
        if table.crc == crc:
            return table
    if not given:
        return None
    known = ", ".join(f"{table.name} 0x{table.crc:04x}" for table in given)
    raise UserError(
        f"{log.name}: it was recorded with parameter set 0x{crc:04x}, but there are only {known}; give the set of that "
        "recording (greywhale params backup) with --controller, or none at all."
    )


def _only_one(log: Log, given: Sequence[Table]) -> Table | None:
    if len(given) > 1:
        raise UserError(f"{log.name}: its header has no parameter_crc, so only one --controller may be given.")
    if not given:
        return None
    period = log.origin.period_ms
    stated = given[0].values[schema.PARAMETER_BY_NAME["period_ms"].index]
    if period is not None and period != stated:
        raise UserError(
            f"{log.name}: its control period is {period} ms, but {given[0].name} has {stated} ms; "
            "give the controller of that recording."
        )
    return given[0]
