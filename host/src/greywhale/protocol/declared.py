"""The parts of the generated module greywhale.protocol.schema: described enums, messages, the parameter table.

Raw values are the integers of the link; physical values are floats in the parameter's unit (radians, mV, 1/rad, ...).
"""

from __future__ import annotations

import math
import struct
from binascii import crc_hqx
from collections.abc import Sequence
from dataclasses import dataclass, fields
from enum import IntEnum
from typing import ClassVar, Protocol, Self, TypeVar

from greywhale.base import sentences
from greywhale.base.errors import BAD_USAGE, BadUsage, UserError

CRC_START = 0xFFFF  # of tables and frames
_CODES = {"u8": "B", "i8": "b", "u16": "H", "i16": "h", "u32": "I", "i32": "i"}


class MessageError(UserError):
    """A payload that does not match the schema: the other side speaks another version."""


class Described(IntEnum):
    """An enum whose members say what they mean and, where it helps, what to do."""

    description: str
    remedy: str
    detail: str

    def __new__(cls, value: int, description: str = "", remedy: str = "", detail: str = "") -> Self:
        member = int.__new__(cls, value)
        member._value_ = value
        member.description = description
        member.remedy = remedy
        member.detail = detail
        return member

    @property
    def key(self) -> str:
        """The name as the declarations, logs and JSON have it: soft_start."""
        return self.name.lower()

    @classmethod
    def of(cls, value: int) -> Self:
        """The member of a received value."""
        try:
            return cls(value)
        except ValueError:
            known = ", ".join(f"{member.value} {member.key}" for member in cls)
            raise MessageError(
                f"The board sent {value} as its {cls.__name__}, but this host knows only {known}: "
                "flash the firmware that belongs to this host with `greywhale flash`."
            ) from None


class Message:
    """One payload in one direction. Generated subclasses are frozen dataclasses."""

    __slots__ = ()
    NAME: ClassVar[str]
    TYPE: ClassVar[int]
    SIZE: ClassVar[int]
    LSB: ClassVar[dict[str, float]]

    def pack(self) -> bytes:
        raise NotImplementedError

    @classmethod
    def unpack(cls, payload: bytes) -> Message:
        raise NotImplementedError

    def _checked(self, layout: struct.Struct, *values: int) -> bytes:
        try:
            return layout.pack(*values)
        except struct.error as error:
            shown = ", ".join(f"{field.name} = {getattr(self, field.name)}" for field in fields(self))  # type: ignore[arg-type]
            raise MessageError(
                f"The message {self.NAME} cannot carry {shown}: {error}; choose values that fit.", BAD_USAGE
            ) from error


Reply_co = TypeVar("Reply_co", bound=Message, covariant=True)


class Request(Protocol[Reply_co]):
    """A message that is answered; it gives `ask(request: Request[R]) -> R` its type."""

    NAME: ClassVar[str]
    TYPE: ClassVar[int]

    def pack(self) -> bytes: ...

    def reply(self, payload: bytes) -> Reply_co: ...


def check_length(message: type[Message], payload: bytes) -> None:
    """Raises unless the payload is as long as the message."""
    if len(payload) != message.SIZE:
        raise MessageError(
            f"The board sent {len(payload)} bytes as {message.__name__}, but this host expects {message.SIZE}: "
            "flash the firmware that belongs to this host with `greywhale flash`."
        )


@dataclass(frozen=True, slots=True)
class Field:
    """A parameter as declared, once for all elements of its group; minimum, maximum and defaults are raw."""

    name: str
    kind: str
    unit: str
    lsb: float
    minimum: int
    maximum: int
    defaults: tuple[int, ...]
    nonzero: bool
    below: str | None
    description: str


@dataclass(frozen=True, slots=True)
class Group:
    name: str
    count: int
    description: str
    since: int  # the first layout that has it
    fields: tuple[Field, ...]


@dataclass(frozen=True, slots=True)
class Parameter:
    """One entry of the table: "joint2.kp". minimum, maximum and default are raw."""

    index: int
    name: str
    kind: str
    unit: str
    lsb: float
    minimum: int
    maximum: int
    default: int
    nonzero: bool
    below: str | None
    description: str
    group: str
    element: int
    since: int  # the first layout that has it

    def to_physical(self, raw: int) -> float:
        return raw * self.lsb

    def to_raw(self, physical: float) -> int:
        """The nearest raw value; UserError when it is not finite or out of range."""
        if not math.isfinite(physical):
            words = sentences.PARAMETER_NOT_FINITE
            raise BadUsage(words.format(name=self.name, value=physical, advice=self._advice()))
        scaled = physical / self.lsb + 0.5
        raw = math.floor(scaled) if math.isfinite(scaled) else 1 << 63  # beyond every range
        self._check(raw, physical)
        return raw

    def to_raw_as_given(self, physical: float) -> int:
        """As to_raw, for a number that a person gave: refused where rounding would change it noticeably."""
        raw = self.to_raw(physical)
        if self.lsb == 1.0 and raw != physical:
            raise BadUsage(sentences.NOT_WHOLE.format(name=self.name, value=self.shown(physical)))
        if raw == 0 and physical != 0.0:
            value, least = self.shown(physical), self.shown(self.lsb)
            raise BadUsage(sentences.TOO_SMALL.format(name=self.name, value=value, least=least))
        return raw

    def check_raw(self, raw: int) -> None:
        """Raises UserError unless the raw value is in range."""
        self._check(raw, self.to_physical(raw))

    def _check(self, raw: int, physical: float) -> None:
        if not self.minimum <= raw <= self.maximum or (self.nonzero and raw == 0):
            value = self.shown(physical)
            raise BadUsage(sentences.OUT_OF_RANGE.format(name=self.name, value=value, advice=self._advice()))

    def shown(self, physical: float) -> str:
        """A value in words, with its unit."""
        return f"{physical:.6g} {self.unit}" if self.unit else f"{physical:.6g}"

    def _advice(self) -> str:
        words = sentences.CHOOSE_BUT_0 if self.nonzero else sentences.CHOOSE
        least, most = self.to_physical(self.minimum), self.to_physical(self.maximum)
        return words.format(least=f"{least:.6g}", most=self.shown(most))


class Table:
    """All parameters in the order of their flat index, and their packed form."""

    def __init__(self, groups: tuple[Group, ...]) -> None:
        self.groups = groups
        self.parameters = tuple(_expand(groups))
        self._layout = struct.Struct("<" + "".join(_CODES[parameter.kind] for parameter in self.parameters))
        self._index = {parameter.name: parameter.index for parameter in self.parameters}
        self.size = self._layout.size

    def pack(self, raw: Sequence[int]) -> bytes:
        if len(raw) != len(self.parameters):
            raise UserError(
                f"A parameter set has {len(self.parameters)} values, but {len(raw)} were given; give them all."
            )
        for parameter, value in zip(self.parameters, raw, strict=True):
            parameter.check_raw(value)
        return self._layout.pack(*raw)

    def unpack(self, data: bytes) -> tuple[int, ...]:
        if len(data) != self.size:
            raise UserError(f"A packed parameter set has {self.size} bytes, but {len(data)} were given; give them all.")
        return self._layout.unpack(data)

    def crc(self, raw: Sequence[int]) -> int:
        return crc_hqx(self.pack(raw), CRC_START)

    def check(self, raw: Sequence[int]) -> None:
        """Check ranges, and what one value demands of another: the firmware's own checks, except for the fuzzy sets."""
        self.pack(raw)
        for parameter in self.parameters:
            if parameter.below is None:
                continue
            other = self.parameters[self._index[f"{parameter.group}{parameter.element}.{parameter.below}"]]
            if raw[parameter.index] >= raw[other.index]:
                low, high = parameter.to_physical(raw[parameter.index]), other.to_physical(raw[other.index])
                value, most = f"{low:.6g}", other.shown(high)
                raise BadUsage(
                    sentences.NOT_BELOW.format(name=parameter.name, value=value, other=other.name, most=most)
                )


def _expand(groups: tuple[Group, ...]) -> list[Parameter]:
    parameters: list[Parameter] = []
    for group in groups:
        for element in range(group.count):
            prefix = f"{group.name}{element}." if group.name else ""
            parameters += [
                Parameter(
                    index=len(parameters) + place,
                    name=prefix + field.name,
                    kind=field.kind,
                    unit=field.unit,
                    lsb=field.lsb,
                    minimum=field.minimum,
                    maximum=field.maximum,
                    default=field.defaults[element],
                    nonzero=field.nonzero,
                    below=field.below,
                    description=field.description,
                    group=group.name,
                    element=element,
                    since=group.since,
                )
                for place, field in enumerate(group.fields)
            ]
    return parameters
