"""The columns of another program's file that become those of a log, each with its unit, sign and offset."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from greywhale.base.errors import BadUsage, cut
from greywhale.files.log.layout import COLUMNS, QUANTITIES
from greywhale.files.log.units import TIME_UNITS
from greywhale.protocol.firmware import JOINTS

TIME, STATE = "time_s", "state"
NUMBERS = tuple(column for column in COLUMNS if column != STATE)
# So much of each unit is one of the log's.
_ANGLES = {"rad": 1.0, "deg": math.pi / 180.0, "mrad": 1e-3, "rev": 2.0 * math.pi}
UNITS: Mapping[str, Mapping[str, float]] = {
    TIME: {"s": 1.0} | {name: 1.0 / factor for name, factor in TIME_UNITS.items()},
    "leader": _ANGLES,
    "follower": _ANGLES,
    "voltage": {"V": 1.0, "mV": 1e-3},
}
_FORM = "such as --column follower_0=q1,deg,-1,12.5: COLUMN=NAME, and where wanted its unit, sign and offset"


@dataclass(frozen=True)
class Rule:
    """A log's number is `unit` times (`sign` times the column's number plus `offset`)."""

    source: str
    unit: float = 1.0
    sign: float = 1.0
    offset: float = 0.0  # in the column's unit

    @property
    def plain(self) -> bool:
        return (self.unit, self.sign, self.offset) == (1.0, 1.0, 0.0)


@dataclass(frozen=True)
class ColumnMap:
    """The rules by the log's columns, and the joints that have all of theirs."""

    rules: Mapping[str, Rule] = field(default_factory=dict)
    joints: tuple[int, ...] = ()


def parse_rule(text: str) -> tuple[str, Rule]:
    """A column of the log and its rule, of `follower_0=q1,deg,-1,12.5`; BadUsage for anything else."""
    target, equals, right = text.partition("=")
    source, *rest = (part.strip() for part in right.split(","))
    target = target.strip()
    if not equals or not source or len(rest) > 3:
        raise BadUsage(f"--column {cut(text)}: it must be {_FORM}.")
    if target not in COLUMNS:
        raise BadUsage(f"--column {cut(text)}: a log has no column {cut(target)}; it has {', '.join(COLUMNS)}.")
    unit, sign, offset = (*rest, *("", "", "")[len(rest) :])
    if target == STATE:
        if rest:
            raise BadUsage(f"--column {cut(text)}: states are words, without unit, sign and offset.")
        return target, Rule(source)
    units = UNITS[TIME if target == TIME else target.rpartition("_")[0]]
    if unit and unit not in units:
        raise BadUsage(f"--column {cut(text)}: {cut(unit)} is no unit of {target}; give one of {', '.join(units)}.")
    if sign not in {"", "1", "+1", "-1"}:
        raise BadUsage(f"--column {cut(text)}: the sign is {cut(sign)}, but it must be 1 or -1.")
    return target, Rule(source, units[unit] if unit else 1.0, float(sign or 1), _offset(offset, text))


def _offset(offset: str, text: str) -> float:
    try:
        value = float(offset or 0)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise BadUsage(f"--column {cut(text)}: the offset {cut(offset)} is not a number.")
    return value


def choose(name: str, there: Sequence[str], usual: Mapping[str, Rule], asked: Mapping[str, Rule]) -> ColumnMap:
    """The rules for a file `name` that has the columns `there`: those asked for, then the format's usual ones, then
    columns with a log's own names. BadUsage names what is missing.
    """
    own = {column: Rule(column) for column in COLUMNS if column in there}
    rules = own | {column: rule for column, rule in usual.items() if rule.source in there} | dict(asked)
    gone = next((rule.source for rule in rules.values() if rule.source not in there), None)
    if gone is not None:
        raise BadUsage(f"{name}: it has no column {cut(gone)}; it has {_listed(there)}.")
    wanted = {joint: [f"{quantity}_{joint}" for quantity in QUANTITIES] for joint in range(JOINTS)}
    some = {joint: columns for joint, columns in wanted.items() if any(column in rules for column in columns)} or {
        0: wanted[0]
    }
    missing = [
        column for column in (TIME, *(one for columns in some.values() for one in columns)) if column not in rules
    ]
    if missing:
        raise BadUsage(
            f"{name}: nothing says what {', '.join(missing)} of a log {'is' if len(missing) == 1 else 'are'}; say it "
            f"with --column {missing[0]}=NAME, one of {_listed(there)}."
        )
    return ColumnMap(rules, tuple(some))


def _listed(names: Sequence[str]) -> str:
    return cut(", ".join(names), 300)
