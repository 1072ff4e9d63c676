"""Writes docs/link.md, the reference page of the link."""

from __future__ import annotations

from fractions import Fraction

from . import NOTICE
from .declaration import REPLY_BIT, Declaration, Enum, Field, Group, Message, Parameter


def page(declaration: Declaration) -> str:
    """Text of docs/link.md."""
    parts = [
        f"<!-- {NOTICE} -->",
        "# The serial link",
        _frame(declaration),
        "## Messages\n\nA field's line has the byte where it begins, its type, its name and its meaning.",
        *_messages(declaration),
        "## Lists of values",
        *(_enum(enum) for enum in declaration.enums),
        "## Parameters",
        _table(declaration),
        *_groups(declaration),
    ]
    return "\n\n".join(parts) + "\n"


def _frame(declaration: Declaration) -> str:
    return f"""For whoever writes another host, or reads a parameter's meaning. Protocol {declaration.protocol}, schema hash `0x{declaration.schema_hash:08X}`.
1 Mbaud, 8 data bits, no parity, 1 stop bit.

```
wire:  COBS( type u8 | seq u8 | payload, at most {declaration.max_payload} bytes | crc u16 ) 00
```

- Numbers are little-endian, two's complement. The CRC is CRC-16/CCITT-FALSE (polynomial 0x1021, start 0xFFFF, no
  reflection, check value 0x29B1; Python: `binascii.crc_hqx(data, 0xFFFF)`) over type, seq and payload.
- The byte 00 stands between frames and nowhere else; a receiver that has lost its place waits for the next one. Empty
  frames (00 00) mean nothing, so that a sender may begin with a 00.
- A request is answered by its type + 0x{REPLY_BIT:02X} with the same seq, or by `nack`. Every request may be repeated:
  a host that hears nothing sends the same frame again. A frame that is not understood (length, coding, CRC) is counted
  and not answered.
- `hello` keeps its type, and its reply keeps the protocol version as its first byte, in every version to come."""


def _type(field: Field) -> str:
    return field.kind + (f"[{field.count}]" if field.count else "")


def _meaning(field: Field) -> str:
    enum = f" ([{field.enum}](#{field.enum.lower()}))" if field.enum else ""
    return field.meaning + enum


def _messages(declaration: Declaration) -> list[str]:
    replies = {message.type: message for message in declaration.messages}
    parts = []
    for message in declaration.messages:
        if message.struct.endswith("Reply"):
            continue
        sides = {"": message}
        if message.reply is not None:
            reply = replies[message.type + REPLY_BIT]
            sides = {"request": message, f"reply 0x{reply.type:02X}": reply}
        parts.append(f"### {message.name} (0x{message.type:02X})\n\n{message.description}")
        parts += [_fields(side or "payload", one) for side, one in sides.items()]
    return parts


def _bytes(count: int) -> str:
    return "1 byte" if count == 1 else f"{count or 'no'} bytes"


def _fields(side: str, message: Message) -> str:
    """A message's size, and a line for each field: where it begins, its type and what it says."""
    head = f"{side[0].upper()}{side[1:]}: {_bytes(message.size)}."
    lines, offset = [], 0
    for field in message.fields:
        lines.append(f"- {offset}, {_type(field)} `{field.name}`: {_meaning(field)}")
        offset += field.size
    return "\n".join([head, "", *lines]) if lines else head


def _enum(enum: Enum) -> str:
    remedies = any(value.remedy for value in enum.values)
    details = any(value.detail for value in enum.values)
    causes = any(value.cause for value in enum.values)
    more = ["detail"] * details + ["raised when"] * causes + ["what to do"] * remedies
    head = ["value", "name", "meaning", *more]
    rows = [
        [str(value.value), f"`{value.name}`", value.description]
        + [value.detail] * details
        + [value.cause] * causes
        + [value.remedy] * remedies
        for value in enum.values
    ]
    lines = [
        _row(head),
        _line(len(head)),
        *(_row(row) for row in rows),
    ]
    return "\n".join([f"### {enum.name}", "", enum.description, "", *lines])


def _line(columns: int) -> str:
    """The line below a table's head: numbers in the first column, text in the others."""
    return f"|---:{'|---' * (columns - 1)}|"


def _row(cells: list[str]) -> str:
    escaped = (cell.replace("|", "\\|") for cell in cells)
    return f"| {' | '.join(escaped)} |"


def _table(declaration: Declaration) -> str:
    return f"""{declaration.parameter_count} parameters, {declaration.table_size} bytes packed in index order
without padding; `param_crc` is the CRC of these bytes. `param_set` writes a staged copy, `param_apply` checks it whole
and makes it the running set between two ticks, `param_save` writes the running set to EEPROM. The EEPROM banks have
layout {declaration.layout}. A board also reads banks of older layouts, which lack the groups at the end (each says
since which layout it exists), and adds their defaults. When it finds a newer layout, it starts from the defaults.

A bank is magic 0x5747 u16, layout u8, length u16, sequence u16, the packed table, and the CRC of layout to table u16. Bank
A is at address 16, bank B at 272; a save writes the older one and sets its magic last, and a board starts from the newer
of the whole ones.

On the link a parameter is a raw integer: physical value = raw x lsb."""


def _number(raw: int, lsb: Fraction) -> str:
    value = float(raw * lsb)
    return f"{value:.4g}" if lsb != 1 else str(raw)


def _default(parameter: Parameter) -> str:
    shown = list(dict.fromkeys(_number(raw, parameter.lsb) for raw in parameter.defaults))
    return shown[0] if len(shown) == 1 else " / ".join(_number(raw, parameter.lsb) for raw in parameter.defaults)


def _groups(declaration: Declaration) -> list[str]:
    parts, first = [], 0
    for group in declaration.groups:
        parts.append(_group(group, first))
        first += group.count * len(group.parameters)
    return parts


def _group(group: Group, first: int) -> str:
    step = len(group.parameters)
    last = first + group.count * step - 1
    where = f"Index {first}..{last}" + (f": {first} + {step} x element + place." if group.count > 1 else ".")
    if group.since > 1:
        where += f" Since layout {group.since}."
    rows = [
        _row(
            [
                str(place if group.count > 1 else first + place),
                f"`{group.name + 'N.' if group.name else ''}{p.name}`",
                p.kind,
                p.unit,
                str(p.lsb),
                f"{_number(p.minimum, p.lsb)} .. {_number(p.maximum, p.lsb)}{', not 0' if p.nonzero else ''}",
                _default(p),
                p.description + (f"; below {p.below}" if p.below else ""),
            ]
        )
        for place, p in enumerate(group.parameters)
    ]
    head = ["place" if group.count > 1 else "index", "name", "type", "unit", "lsb", "range", "default", "meaning"]
    return "\n".join([f"### {group.title}", "", group.description, "", where, "", _row(head), _line(len(head)), *rows])
