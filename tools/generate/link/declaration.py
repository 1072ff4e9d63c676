"""Loads shared/link/*.toml into plain objects and refuses declarations that contradict themselves.

Knows widths, ranges and order; knows nothing of the languages that are generated.
"""

from __future__ import annotations

import json
import math
import re
import tomllib
import zlib
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

WIDTHS = {"u8": 1, "i8": 1, "u16": 2, "i16": 2, "u32": 4, "i32": 4}
REPLY_BIT = 0x80
_TYPE = re.compile(r"(u8|i8|u16|i16|u32|i32)(?:\[(\d+)\])?")


MAX_TABLE_BYTES = 247  # of the 256 of a bank in the EEPROM, the rest is its head and its CRC: params/store.h
_MORE_WORDS = ("remedy", "detail", "cause")


class DeclarationError(Exception):
    """One sentence: which file, which entry, what to change."""


@dataclass(frozen=True)
class EnumValue:
    name: str
    value: int
    description: str
    remedy: str
    detail: str
    cause: str = ""

    @property
    def texts(self) -> list[str]:
        """Description, remedy and detail, without those at the end that are empty."""
        count = 3 if self.detail else 2 if self.remedy else 1
        return [self.description, self.remedy, self.detail][:count]


@dataclass(frozen=True)
class Enum:
    name: str
    description: str
    values: tuple[EnumValue, ...]


@dataclass(frozen=True)
class Field:
    name: str
    kind: str
    count: int | None
    enum: str | None
    unit: str
    lsb: Fraction | None
    description: str

    @property
    def size(self) -> int:
        return WIDTHS[self.kind] * (self.count or 1)

    @property
    def meaning(self) -> str:
        """The description with the unit."""
        lsb = f"{self.lsb} " if self.lsb else ""
        return f"{self.description} [{lsb}{self.unit}]" if self.unit else self.description


@dataclass(frozen=True)
class Message:
    """One payload in one direction: HelloRequest, HelloReply, Sample, Nack."""

    name: str
    struct: str
    type: int
    fields: tuple[Field, ...]
    description: str
    reply: str | None

    @property
    def size(self) -> int:
        return sum(field.size for field in self.fields)


@dataclass(frozen=True)
class Parameter:
    name: str
    kind: str
    unit: str
    lsb: Fraction
    minimum: int
    maximum: int
    defaults: tuple[int, ...]
    nonzero: bool
    below: str | None
    description: str


@dataclass(frozen=True)
class Group:
    name: str
    struct: str
    title: str
    description: str
    count: int
    parameters: tuple[Parameter, ...]
    member: str  # of the firmware's table
    since: int  # the first layout that has it

    @property
    def size(self) -> int:
        return sum(WIDTHS[parameter.kind] for parameter in self.parameters)


@dataclass(frozen=True)
class Declaration:
    protocol: int
    max_payload: int
    enums: tuple[Enum, ...]
    messages: tuple[Message, ...]
    layout: int
    groups: tuple[Group, ...]
    schema_hash: int

    @property
    def table_size(self) -> int:
        return self.layout_size(self.layout)

    def layout_size(self, layout: int) -> int:
        """Bytes of the table in this or an older layout: the beginning of today's."""
        return sum(group.count * group.size for group in self.groups if group.since <= layout)

    @property
    def parameter_count(self) -> int:
        return sum(group.count * len(group.parameters) for group in self.groups)


def limits(kind: str) -> tuple[int, int]:
    """Smallest and largest value of an integer type."""
    bits = 8 * WIDTHS[kind]
    return (-(1 << (bits - 1)), (1 << (bits - 1)) - 1) if kind[0] == "i" else (0, (1 << bits) - 1)


def load(folder: Path) -> Declaration:
    """Reads messages.toml, enums.toml and parameters.toml of the folder."""
    links = _read(folder / "messages.toml")
    lists = _read(folder / "enums.toml")
    table = _read(folder / "parameters.toml")
    try:
        enums = tuple(_enum(entry) for entry in lists["enum"])
        messages = _messages(links["message"], {enum.name for enum in enums})
        groups = tuple(_group(entry) for entry in table["group"])
        declaration = Declaration(
            protocol=links["protocol"],
            max_payload=links["frame"]["max_payload"],
            enums=enums,
            messages=messages,
            layout=table["layout"],
            groups=groups,
            schema_hash=_schema_hash(links["protocol"], enums, messages, groups),
        )
    except KeyError as error:
        raise DeclarationError(f"{folder}: an entry lacks the key {error}; add it.") from error
    _check(declaration, table["layout_hash"])
    return declaration


def _read(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise DeclarationError(f"{path}: {error}.") from error


def _enum(entry: dict[str, Any]) -> Enum:
    values = tuple(
        EnumValue(value["name"], value["value"], value["description"], *(value.get(key, "") for key in _MORE_WORDS))
        for value in entry["values"]
    )
    if len({value.value for value in values}) != len(values) or not all(0 <= value.value <= 255 for value in values):
        raise DeclarationError(f"enums.toml: {entry['name']} repeats a value or leaves 0..255; number its values anew.")
    return Enum(entry["name"], entry["description"], values)


def _field(entry: dict[str, Any], enums: set[str]) -> Field:
    match = _TYPE.fullmatch(entry["type"])
    if match is None:
        raise DeclarationError(
            f"messages.toml: {entry['name']} has the type {entry['type']}; use u8 to i32, with [n] for arrays."
        )
    enum = entry.get("enum")
    if enum is not None and (enum not in enums or entry["type"] != "u8"):
        raise DeclarationError(
            f"messages.toml: {entry['name']} names the enum {enum}; declare it in enums.toml and use type u8."
        )
    count = int(match[2]) if match[2] else None
    lsb = Fraction(entry["lsb"]) if "lsb" in entry else None
    return Field(entry["name"], match[1], count, enum, entry.get("unit", ""), lsb, entry["description"])


def _messages(entries: list[dict[str, Any]], enums: set[str]) -> tuple[Message, ...]:
    messages: list[Message] = []
    for entry in entries:
        name, number = entry["name"], entry["type"]
        camel = name.title().replace("_", "")

        def make(key: str, suffix: str, number: int, reply: str | None, entry: dict[str, Any] = entry) -> Message:
            fields = tuple(_field(field, enums) for field in entry[key])
            name = entry["name"].title().replace("_", "") + suffix
            return Message(entry["name"], name, number, fields, entry["description"], reply)

        if "fields" in entry:
            messages.append(make("fields", "", number, None))
        else:
            messages.append(make("request", "Request", number, camel + "Reply"))
            messages.append(make("reply", "Reply", number | REPLY_BIT, None))
    return tuple(messages)


def _raw(value: Any, lsb: Fraction) -> int:
    return math.floor(Fraction(value) / lsb + Fraction(1, 2))


def _parameter(entry: dict[str, Any], count: int) -> Parameter:
    lsb = Fraction(entry.get("lsb", 1))
    defaults = entry["default"] if isinstance(entry["default"], list) else [entry["default"]] * count
    parameter = Parameter(
        name=entry["name"],
        kind=entry["type"],
        unit=entry["unit"],
        lsb=lsb,
        minimum=_raw(entry["min"], lsb),
        maximum=_raw(entry["max"], lsb),
        defaults=tuple(_raw(default, lsb) for default in defaults),
        nonzero=entry.get("nonzero", False),
        below=entry.get("below"),
        description=entry["description"],
    )
    low, high = limits(parameter.kind)
    low, high = max(low, parameter.minimum), min(high, parameter.maximum, 2**31 - 1)
    fits = low == parameter.minimum and high == parameter.maximum and len(defaults) == count
    if not fits or not all(
        low <= default <= high and (default or not parameter.nonzero) for default in parameter.defaults
    ):
        raise DeclarationError(
            f"parameters.toml: min, max or default of {entry['name']} does not fit its type; change one of them."
        )
    return parameter


def _group(entry: dict[str, Any]) -> Group:
    parameters = tuple(_parameter(parameter, entry["count"]) for parameter in entry["parameters"])
    if entry["name"] == "" and entry["count"] != 1:
        raise DeclarationError("parameters.toml: a group without a name must have the count 1.")
    title = entry["title"] if entry["name"] == "" else f"{entry['name']}0 .. {entry['name']}{entry['count'] - 1}"
    return Group(
        entry["name"],
        entry.get("struct", ""),
        title,
        entry["description"],
        entry["count"],
        parameters,
        entry.get("member", entry["name"]),
        entry.get("since", 1),
    )


def _schema_hash(
    protocol: int, enums: tuple[Enum, ...], messages: tuple[Message, ...], groups: tuple[Group, ...]
) -> int:
    """CRC-32 over everything that both sides must agree on: no descriptions, no remedies."""
    canonical = {
        "protocol": protocol,
        "enums": [[enum.name, [[value.name, value.value] for value in enum.values]] for enum in enums],
        "messages": [
            [m.struct, m.type, [[f.name, f.kind, f.count, f.enum, str(f.lsb)] for f in m.fields]] for m in messages
        ],
        "groups": [
            [
                g.name,
                g.count,
                [
                    [p.name, p.kind, str(p.lsb), p.minimum, p.maximum, list(p.defaults), p.nonzero, p.below]
                    for p in g.parameters
                ],
            ]
            for g in groups
        ],
    }
    return zlib.crc32(json.dumps(canonical, separators=(",", ":")).encode("ascii"))


def _layout_hash(declaration: Declaration) -> int:
    layout = [[g.name, g.count, [[p.name, p.kind, str(p.lsb)] for p in g.parameters]] for g in declaration.groups]
    return zlib.crc32(json.dumps([declaration.layout, layout], separators=(",", ":")).encode("ascii"))


def _check(declaration: Declaration, layout_hash: int) -> None:
    names = [message.struct for message in declaration.messages]
    numbers = [message.type for message in declaration.messages]
    if len(set(names)) != len(names) or len(set(numbers)) != len(numbers):
        raise DeclarationError("messages.toml: two messages share a name or a type; give each its own.")
    for message in declaration.messages:
        if message.size > declaration.max_payload:
            raise DeclarationError(
                f"messages.toml: {message.struct} has {message.size} bytes, more than max_payload; shorten it."
            )
    for group in declaration.groups:
        for parameter in group.parameters:
            if parameter.below is not None and parameter.below not in {other.name for other in group.parameters}:
                raise DeclarationError(
                    f"parameters.toml: {parameter.name} is below {parameter.below}, which its group lacks."
                )
    since = [1, *(group.since for group in declaration.groups), declaration.layout]
    if since != sorted(since):
        raise DeclarationError("parameters.toml: a group's `since` is below that of one before; put new groups last.")
    if declaration.table_size > MAX_TABLE_BYTES or declaration.parameter_count > 255:
        raise DeclarationError(
            f"parameters.toml: the table is larger than {MAX_TABLE_BYTES} bytes or 255 parameters; "
            "widen the store first."
        )
    if _layout_hash(declaration) != layout_hash:
        raise DeclarationError(
            "parameters.toml: order, type, lsb or layout number changed; raise `layout` "
            f"if boards in use have the old one, and set layout_hash = 0x{_layout_hash(declaration):08X}."
        )
