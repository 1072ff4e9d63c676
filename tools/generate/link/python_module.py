"""Writes the host's Python module: enums, messages with pack and unpack, the parameter list."""

from __future__ import annotations

import json

from . import NOTICE
from .declaration import Declaration, Enum, Field, Group, Message

CODES = {"u8": "B", "i8": "b", "u16": "H", "i16": "h", "u32": "I", "i32": "i"}


def module(declaration: Declaration) -> str:
    """Text of greywhale/protocol/schema.py."""
    parts = [
        f'"""Messages, enums and parameters of the serial link.\n\n{NOTICE}\n"""',
        "# ruff: noqa: E501\n# fmt: off",
        f"{_IMPORTS}\n\n"
        f"PROTOCOL = {declaration.protocol}\n"
        f"SCHEMA_HASH = 0x{declaration.schema_hash:08X}\n"
        f"MAX_PAYLOAD = {declaration.max_payload}\n"
        f"REPLY_BIT = 0x80\n"
        f"LAYOUT = {declaration.layout}",
        *(_enum(enum) for enum in declaration.enums),
        *(_message(message, declaration) for message in declaration.messages),
        _registry(declaration),
        _parameters(declaration),
    ]
    return "\n\n\n".join(parts) + "\n"


_IMPORTS = """from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from struct import Struct
from typing import ClassVar

from .declared import Described, Field, Group, Message, Parameter, Table, check_length"""


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _enum(enum: Enum) -> str:
    lines = [f"class {enum.name}(Described):", f'    """{enum.description}"""', ""]
    for value in enum.values:
        lines.append(f"    {value.name.upper()} = {value.value}, {', '.join(map(_text, value.texts))}")
    return "\n".join(lines)


def _hint(field: Field) -> str:
    kind = field.enum or "int"
    return f"tuple[{', '.join([kind] * field.count)}]" if field.count else kind


def _format(message: Message) -> str:
    return "<" + "".join((str(field.count) if field.count else "") + CODES[field.kind] for field in message.fields)


def _message(message: Message, declaration: Declaration) -> str:
    private = f"_{message.struct.upper()}"
    lsb = {field.name: float(field.lsb) for field in message.fields if field.lsb is not None}
    lines = [
        f'{private} = Struct("{_format(message)}")',
        "",
        "",
        "@dataclass(frozen=True, slots=True)",
        f"class {message.struct}(Message):",
        f'    """{message.description}"""',
        "",
        f'    NAME: ClassVar[str] = "{message.name}"',
        f"    TYPE: ClassVar[int] = 0x{message.type:02X}",
        f"    SIZE: ClassVar[int] = {message.size}",
        f"    LSB: ClassVar[dict[str, float]] = {lsb!r}",
        "",
    ]
    for field in message.fields:
        lines.append(f"    {field.name}: {_hint(field)}  # {field.meaning}")
    if message.fields:
        lines.append("")
    lines += _pack(message, private)
    lines += ["", *_unpack(message, private)]
    if message.reply is not None:
        lines += [
            "",
            f"    def reply(self, payload: bytes) -> {message.reply}:",
            f"        return {message.reply}.unpack(payload)",
        ]
    return "\n".join(lines)


def _pack(message: Message, private: str) -> list[str]:
    if not message.fields:
        return ["    def pack(self) -> bytes:", '        return b""']
    values = ", ".join(("*" if field.count else "") + f"self.{field.name}" for field in message.fields)
    return ["    def pack(self) -> bytes:", f"        return self._checked({private}, {values})"]


def _unpack(message: Message, private: str) -> list[str]:
    lines = [
        "    @classmethod",
        f"    def unpack(cls, payload: bytes) -> {message.struct}:",
        "        if len(payload) != cls.SIZE:",
        "            check_length(cls, payload)",
    ]
    if not message.fields:
        return [*lines, "        return cls()"]
    names: list[str] = []
    values: list[str] = []
    for field in message.fields:
        parts = [f"{field.name}_{i}" for i in range(field.count)] if field.count else [field.name]
        names += parts
        values.append(
            f"({', '.join(parts)})" if field.count else f"{field.enum}.of({field.name})" if field.enum else field.name
        )
    target = ", ".join(names) + ("," if len(names) == 1 else "")
    return [*lines, f"        {target} = {private}.unpack(payload)", f"        return cls({', '.join(values)})"]


def _registry(declaration: Declaration) -> str:
    names = [message.struct for message in declaration.messages]
    return "\n".join(["MESSAGES: tuple[type[Message], ...] = (", *(f"    {name}," for name in names), ")"])


def _parameters(declaration: Declaration) -> str:
    lines = ["TABLE = Table((", *(line for group in declaration.groups for line in _group(group)), "))"]
    return "\n".join(lines) + "\n" + _PARAMETER_API


def _group(group: Group) -> list[str]:
    lines = [f"    Group({_text(group.name)}, {group.count}, {_text(group.description)}, {group.since}, ("]
    for p in group.parameters:
        lines.append(
            f"        Field({_text(p.name)}, {_text(p.kind)}, {_text(p.unit)}, {float(p.lsb)!r}, "
            f"{p.minimum}, {p.maximum}, {p.defaults!r}, {p.nonzero}, {p.below!r}, {_text(p.description)}),"
        )
    return [*lines, "    )),"]


_PARAMETER_API = '''PARAMETERS: tuple[Parameter, ...] = TABLE.parameters
PARAMETER_BY_NAME: dict[str, Parameter] = {parameter.name: parameter for parameter in PARAMETERS}
DEFAULTS: tuple[int, ...] = tuple(parameter.default for parameter in PARAMETERS)


def pack_parameters(raw: Sequence[int]) -> bytes:
    """The whole table, raw values in index order, as it lies in RAM and EEPROM."""
    return TABLE.pack(raw)


def unpack_parameters(data: bytes) -> tuple[int, ...]:
    """The raw values of a packed table."""
    return TABLE.unpack(data)


def param_crc(raw: Sequence[int]) -> int:
    """The CRC that the board computes over the same set."""
    return TABLE.crc(raw)


def check_parameters(raw: Sequence[int]) -> None:
    """Raises UserError unless every value is in range and the values fit each other."""
    TABLE.check(raw)'''
