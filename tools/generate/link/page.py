"""Writes docs/link.md, the reference page of the link."""

from __future__ import annotations

from fractions import Fraction

from . import NOTICE
from .declaration import REPLY_BIT, Declaration, Enum, Field, Group, Message, Parameter
from .golden import frame

CLEAR = ", then clear the fault"  # ends most faults' remedies; the page says it once


def page(declaration: Declaration) -> str:
    """Text of docs/link.md."""
    parts = [
        f"<!-- {NOTICE} -->",
        "# The serial link",
        _frame(declaration),
        "## Messages\n\nFields follow one another without gaps. A request of which none is told has no payload.",
        *_messages(declaration),
        "## Lists of values",
        *(_enum(enum) for enum in declaration.enums),
        "## Parameters",
        _table(declaration),
        *_groups(declaration),
    ]
    return "\n\n".join(parts) + "\n"


def _frame(declaration: Declaration) -> str:
    hello = next(message for message in declaration.messages if message.name == "hello")
    return f"""For programs that talk to a board, and for the meaning of a parameter. Protocol {declaration.protocol}, schema hash
`0x{declaration.schema_hash:08X}`. 1 Mbaud, 8 data bits, no parity, 1 stop bit.

**Opening the port restarts most boards, and a byte keeps the Mega's bootloader for seconds.** So send nothing until the
firmware's own `hello` reply comes (seq 0), or for 2 s. Requests count 1 to 255; `hello` with 1 is `{frame(hello.type, 1, b"").hex(" ")}` on the wire.

```
wire:  COBS( type u8 | seq u8 | payload, at most {declaration.max_payload} bytes | crc u16 ) 00
```

- Numbers are little-endian, two's complement. The CRC over type, seq and payload is CRC-16/CCITT-FALSE (polynomial
  0x1021, start 0xFFFF, no reflection, check value 0x29B1; Python: `binascii.crc_hqx(data, 0xFFFF)`).
- The byte 00 stands between frames alone. Empty frames mean nothing: a sender may begin with a 00.
- A request is answered by its type + 0x{REPLY_BIT:02X} with the same seq, or by `nack`. A host that hears nothing for 0.3 s
  sends the same frame again. A damaged frame (length, coding, CRC) is counted and not answered.
- `hello`, and the protocol version as the first byte of its reply, stay in every version to come."""


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
        parts += [_fields(side or "payload", one) for side, one in sides.items() if one.fields or side != "request"]
    return parts


def _fields(side: str, message: Message) -> str:
    """A payload's only field behind its name, or its size and a line for each field: its type and what it says."""
    head = f"{side[0].upper()}{side[1:]}"
    told = [f"{_type(field)} `{field.name}`: {_meaning(field)}" for field in message.fields]
    if len(told) < 2:
        return ", ".join([head, *told]) + "."
    return "\n".join([f"{head}, {message.size} bytes:", "", *(f"- {line}" for line in told)])


def _enum(enum: Enum) -> str:
    """A line for each value: its number, name and meaning, the detail, and of a fault what raises it and what to do."""
    lines = []
    for value in enum.values:
        cause = f" When: {value.cause}." if value.cause else ""
        detail = f" Detail: {value.detail}." if value.detail not in ("", "0") else ""
        remedy = f" {value.remedy.replace(CLEAR, '')}" if value.cause else ""
        end = "." if cause or detail or remedy else ""
        lines.append(f"- {value.value} `{value.name}`: {value.description}{end}{detail}{cause}{remedy}")
    remark = ""
    if any(value.remedy for value in enum.values):
        causes = any(value.cause for value in enum.values)
        remark = " Mend the cause, then clear the fault." if causes else " `greywhale` says with each what to do."
    return "\n".join([f"### {enum.name}", "", enum.description + remark, "", *lines])


def _table(declaration: Declaration) -> str:
    return f"""{declaration.parameter_count} parameters, {declaration.table_size} bytes packed in index order; `param_crc` is their CRC. On the link a parameter is a raw
integer: value = raw x lsb (1 where none stands). A line has index or place, name, type, range, lsb (as in the line
above, where missing) and default.

The EEPROM holds layout {declaration.layout}. An older bank lacks groups at the end, which get their defaults; a newer layout means the
defaults. A bank is magic 0x5747 u16, layout u8, length u16, sequence u16, the table, and the CRC of layout to table u16. Bank A
is at address 16, bank B at 272; a save writes the older one and its magic last, and a board starts from the newer whole one."""


def _number(raw: int, lsb: Fraction) -> str:
    value = float(raw * lsb)
    return f"{value:.4g}" if lsb != 1 else str(raw)


def _default(parameter: Parameter) -> str:
    shown = list(dict.fromkeys(_number(raw, parameter.lsb) for raw in parameter.defaults))
    return shown[0] if len(shown) == 1 else "/".join(_number(raw, parameter.lsb) for raw in parameter.defaults)


def _groups(declaration: Declaration) -> list[str]:
    parts, first = [], 0
    known: tuple[Parameter, ...] = ()
    for group in declaration.groups:
        parts.append(_group(group, first, told=group.parameters == known))
        known = group.parameters
        first += group.count * len(group.parameters)
    return parts


def _group(group: Group, first: int, *, told: bool) -> str:
    """A group's places, and a line for each of its parameters, unless the group before has `told` the same."""
    step = len(group.parameters)
    last = first + group.count * step - 1
    where = f"Index {first}" + (f"..{last}" if last > first else "")
    if group.count > 1:
        where += f": {first} + {step} x element + place" if step > 1 else f": {first} + element"
    where += "."
    if group.since > 1:
        where += f" Since layout {group.since}."
    told_facts: str | None = None
    lines: list[str] = []
    for place, one in enumerate(() if told else group.parameters):
        lines.append(f"- {place if group.count > 1 else first + place} {_parameter(group, one, told_facts)}")
        told_facts = _facts(one)
    return "\n".join(
        [f"### {group.title}", "", f"{group.description} {where}".removeprefix(f"{group.title}. "), "", *lines]
    )


def _facts(parameter: Parameter) -> str:
    """Type, range with its unit, and the step where it is not 1."""
    lsb = parameter.lsb
    span = f"{_number(parameter.minimum, lsb)}..{_number(parameter.maximum, lsb)} {parameter.unit}".strip()
    facts = [parameter.kind, span + (", not 0" if parameter.nonzero else "")]
    return ", ".join([*facts, f"lsb {lsb}"] if lsb != 1 else facts)


def _parameter(group: Group, parameter: Parameter, told: str | None) -> str:
    """Name, type, range and step unless the line above has `told` the same, default and meaning."""
    facts = "" if _facts(parameter) == told else f"{_facts(parameter)}; "
    below = f"; below {parameter.below}" if parameter.below else ""
    name = f"{group.name}N.{parameter.name}" if group.name else parameter.name
    return f"`{name}` ({facts}default {_default(parameter)}): {parameter.description}{below}"
