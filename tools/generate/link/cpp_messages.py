"""Writes the C++ header of messages (C++14, no standard library)."""

from __future__ import annotations

from . import NOTICE
from .declaration import REPLY_BIT, WIDTHS, Declaration, Field, Message

C_TYPES = {"u8": "uint8_t", "i8": "int8_t", "u16": "uint16_t", "i16": "int16_t", "u32": "uint32_t", "i32": "int32_t"}


def header(declaration: Declaration) -> str:
    """Text of link/schema.h."""
    parts = [
        f"// Messages of the serial link.\n// {NOTICE}\n#pragma once\n",
        '#include <codes/codes.h>\n#include <stdint.h>\n\n#include "link/bytes.h"\n',
        "namespace wire {\n",
        *(f"using codes::{enum.name};" for enum in declaration.enums),
        "",
        _constants(declaration),
        *(_struct(message) for message in declaration.messages),
        "}  // namespace wire",
    ]
    return "\n".join(parts) + "\n"


def visitor(declaration: Declaration) -> str:
    """Text of messages.h, with which the firmware's tests go through all messages."""
    parts = [
        f"// Every message of the serial link.\n// {NOTICE}\n#pragma once\n",
        '#include "link/schema.h"\n',
        "namespace wire {\n",
        "// Calls visit(name, message) for each.",
        "template <class Visit>\nvoid for_each_message(Visit visit) {",
        *(f'  visit("{message.struct}", {message.struct}{{}});' for message in declaration.messages),
        "}\n",
        "}  // namespace wire",
    ]
    return "\n".join(parts) + "\n"


def _constants(declaration: Declaration) -> str:
    lines = [
        f"constexpr uint8_t protocol = {declaration.protocol};",
        f"constexpr uint32_t schema_hash = 0x{declaration.schema_hash:08X};",
        f"constexpr uint8_t max_payload = {declaration.max_payload};",
        f"constexpr uint8_t reply_bit = 0x{REPLY_BIT:02X};",
        "",
        "// Every request. A switch over them without a default lets the compiler name the one that has no case.",
        "enum class RequestType : uint8_t {",
        *(f"  {m.name} = 0x{m.type:02X}," for m in declaration.messages if m.reply is not None),
        "};",
    ]
    return "\n".join(lines) + "\n"


def _struct(message: Message) -> str:
    lines = [
        f"// {message.description}",
        f"struct {message.struct} {{",
        f"  static constexpr uint8_t type = 0x{message.type:02X};",
        f"  static constexpr uint8_t size = {message.size};",
        *([""] if message.fields else []),
        *(f"  {_member(field)}  // {field.meaning}" for field in message.fields),
        "",
        *_encode(message),
        "",
        *_decode(message),
        "};",
    ]
    return "\n".join(lines) + "\n"


def _member(field: Field) -> str:
    kind = field.enum or C_TYPES[field.kind]
    return f"{kind} {field.name}{f'[{field.count}]' if field.count else ''};"


def _places(message: Message) -> list[tuple[Field, str, int]]:
    """Every scalar of the payload: its field, how C++ names it and its offset."""
    places = []
    offset = 0
    for field in message.fields:
        for i in range(field.count or 1):
            places.append((field, f"{field.name}[{i}]" if field.count else field.name, offset))
            offset += WIDTHS[field.kind]
    return places


def _encode(message: Message) -> list[str]:
    if not message.fields:
        return ["  void encode(uint8_t *) const {}"]
    lines = ["  void encode(uint8_t *out) const {"]
    for field, name, offset in _places(message):
        bits = 8 * WIDTHS[field.kind]
        unsigned = name if field.kind[0] == "u" and not field.enum else f"static_cast<uint{bits}_t>({name})"
        lines.append(f"    put_u{bits}(out + {offset}, {unsigned});")
    return [*lines, "  }"]


def _decode(message: Message) -> list[str]:
    if not message.fields:
        return [
            f"  static bool decode(const uint8_t *, uint8_t length, {message.struct} &) {{ return length == size; }}"
        ]
    lines = [
        f"  static bool decode(const uint8_t *in, uint8_t length, {message.struct} &out) {{",
        "    if (length != size) return false;",
    ]
    for field, name, offset in _places(message):
        bits = 8 * WIDTHS[field.kind]
        value = f"get_u{bits}(in + {offset})"
        kind = field.enum or (C_TYPES[field.kind] if field.kind[0] == "i" else None)
        lines.append(f"    out.{name} = {f'static_cast<{kind}>({value})' if kind else value};")
    return [*lines, "    return true;", "  }"]
