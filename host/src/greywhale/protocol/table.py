"""A board's whole parameter table: values by name, its CRC, and the board that it is for.

Values are raw, the integers that a board stores, unless a name says otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Self

from greywhale.base.errors import UserError
from greywhale.protocol import schema
from greywhale.protocol.declared import Parameter
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.joints import ALL, Joints, unused
from greywhale.protocol.schema import Board

# One joint's controller as the table holds it: sets q14, gains q16, mV, control periods.
CONTROLLER_COLUMNS = (
    "ne_c",
    "ze_a",
    "ze_c",
    "pe_b",
    "nce_c",
    "zce_a",
    "zce_c",
    "pce_b",
    "kp",
    "kd",
    "ki",
    "ku_mv",
    "ce_ticks",
)


@dataclass(frozen=True)
class ParameterTable:
    """`raw` values in index order that a board would accept; `name` says where they come from.

    Raises UserError where a value is out of range or values contradict each other.
    """

    raw: tuple[int, ...]
    board: Board = Board.MEGA2560
    name: str = field(default="the parameter table", compare=False)

    def __post_init__(self) -> None:
        schema.check_parameters(self.raw)

    @classmethod
    def defaults(cls, board: Board = Board.MEGA2560) -> Self:
        """The table of a board as it is shipped."""
        return cls(schema.DEFAULTS, board, "the firmware's defaults")

    def __getitem__(self, name: str) -> int:
        """The raw value of a parameter: table["joint0.kp"]."""
        return self.raw[schema.PARAMETER_BY_NAME[name].index]

    def physical(self, name: str) -> float:
        """The value of a parameter in its unit."""
        return schema.PARAMETER_BY_NAME[name].to_physical(self[name])

    def each(self, group: str, key: str) -> tuple[int, ...]:
        """The raw values of a key of all four joints or potentiometers: table.each("joint", "limit_min")."""
        return tuple(self[f"{group}{number}.{key}"] for number in range(JOINTS))

    @property
    def joints_in_use(self) -> Joints:
        """Those whose follower has a potentiometer: its scale is not 0."""
        return tuple(joint for joint, scale in enumerate(self.each("follower", "scale")) if scale != 0)

    @property
    def crc(self) -> int:
        """The CRC that the board computes over the same set."""
        return schema.param_crc(self.raw)

    @property
    def period_ms(self) -> int:
        """The control period."""
        return self["period_ms"]

    @property
    def supply_v(self) -> float:
        """The motors' supply."""
        return self["supply_mv"] / 1000.0

    @property
    def controllers(self) -> tuple[tuple[int, ...], ...]:
        """(4, 13) raw: a row a joint, in the order of CONTROLLER_COLUMNS."""
        return tuple(tuple(self[f"joint{joint}.{key}"] for key in CONTROLLER_COLUMNS) for joint in range(JOINTS))

    def by_name(self) -> dict[str, int]:
        """All raw values."""
        return {one.name: raw for one, raw in zip(schema.PARAMETERS, self.raw, strict=True)}

    def changes(self) -> dict[str, int]:
        """The raw values that differ from the firmware's defaults, by name."""
        return {one.name: raw for one, raw in zip(schema.PARAMETERS, self.raw, strict=True) if raw != one.default}

    def with_raw(self, changes: Mapping[str, int]) -> Self:
        """A copy of the table with other raw values, by name."""
        values = list(self.raw)
        for name, raw in changes.items():
            values[schema.PARAMETER_BY_NAME[name].index] = raw
        return replace(self, raw=tuple(values))

    def with_joints(self, joints: Joints) -> Self:
        """A copy of the table with neither potentiometer of the joints that are not among these."""
        return self.with_raw({f"{side}{joint}.scale": 0 for side in ("leader", "follower") for joint in unused(joints)})

    def limits_raw(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Lower and upper limits as the firmware keeps them: 0 for joints that are not in use."""
        used = [joint in self.joints_in_use for joint in ALL]
        lower, upper = (self.each("joint", end) for end in ("limit_min", "limit_max"))
        return (
            tuple(limit * one for limit, one in zip(lower, used, strict=True)),
            tuple(limit * one for limit, one in zip(upper, used, strict=True)),
        )

    def with_controllers(self, rows: Iterable[Iterable[int]]) -> Self:
        """A copy of the table with other controllers, (4, 13) raw."""
        return self.with_raw(
            {
                f"joint{joint}.{key}": int(raw)
                for joint, row in enumerate(rows)
                for key, raw in zip(CONTROLLER_COLUMNS, row, strict=True)
            }
        )

    def for_board(self, board: Board) -> Self:
        """A copy of the table for another board."""
        return replace(self, board=board)

    def with_name(self, name: str) -> Self:
        """A copy of the table under another name."""
        return replace(self, name=name)


def physical(parameter: Parameter, raw: int) -> float:
    """The value in the parameter's unit, rounded to the digits that still tell neighbouring raw values apart."""
    digits = max(0, 1 - math.floor(math.log10(parameter.lsb)))
    value = round(parameter.to_physical(raw), digits)
    return int(value) if parameter.lsb == 1.0 else value


def find_board(key: str | None) -> Board:
    """The board that a file names by its key, such as nano328; UNKNOWN where it names none, or an unknown one."""
    return next((board for board in Board if board.key == key), Board.UNKNOWN)


def refuse_unknown(names: Iterable[str], where: str, remedy: str) -> None:
    """Raise UserError where one of the names is no parameter."""
    for name in names:
        if name not in schema.PARAMETER_BY_NAME:
            raise UserError(f"{where}: {name} is no parameter of a board; {remedy}.")
