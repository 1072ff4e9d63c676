"""Writes the page's TypeScript module: enums, messages with their types, the parameter table."""

from __future__ import annotations

import json

from . import NOTICE
from .declaration import Declaration, Enum, Field, Group, Message


def module(declaration: Declaration) -> str:
    """Text of host/web/src/link/schema.ts."""
    parts = [
        f"// Messages, enums and parameters of the serial link.\n// {NOTICE}\n",
        'import { Enumeration, Message, Request, Table } from "./declared";\n',
        f"export const PROTOCOL = {declaration.protocol};\n"
        f"export const SCHEMA_HASH = 0x{declaration.schema_hash:08x};\n"
        f"export const MAX_PAYLOAD = {declaration.max_payload};\n",
        *(_enum(enum) for enum in declaration.enums),
        *(_message(message) for message in declaration.messages),
        _registry(declaration),
        _table(declaration),
    ]
    return "\n".join(parts)


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _enum(enum: Enum) -> str:
    lines = [f"/** {enum.description} */", f"export const {enum.name} = new Enumeration({_text(enum.name)}, {{"]
    for value in enum.values:
        lines.append(f"  {value.name}: [{value.value}, {', '.join(map(_text, value.texts))}],")
    return "\n".join([*lines, "});"]) + "\n"


def _comment(field: Field) -> str:
    enum = f" ({field.enum})" if field.enum else ""
    return field.meaning + enum


def _message(message: Message) -> str:
    lines = [f"/** {message.description} */"]
    if message.fields:
        lines.append(f"export type {message.struct} = {{")
        for field in message.fields:
            lines.append(
                f"  readonly {field.name}: {'readonly number[]' if field.count else 'number'}; // {_comment(field)}"
            )
        lines.append("};")
    else:
        lines.append(f"export type {message.struct} = Record<never, never>;")
    kind = f"Request<{message.struct}, {message.reply}>" if message.reply else f"Message<{message.struct}>"
    fields = ", ".join(_field(field) for field in message.fields)
    reply = f", () => {message.reply}" if message.reply else ""
    lines.append(
        f"export const {message.struct}: {kind} = "
        f"new {kind.partition('<')[0]}({_text(message.name)}, 0x{message.type:02x}, [{fields}]{reply});"
    )
    return "\n".join(lines) + "\n"


def _field(field: Field) -> str:
    parts = [_text(field.name), _text(field.kind)]
    if field.count or field.lsb is not None:
        parts.append(str(field.count or 0))
    if field.lsb is not None:
        parts.append(str(field.lsb))
    return f"[{', '.join(parts)}]"


def _registry(declaration: Declaration) -> str:
    names = [f"  {message.struct}," for message in declaration.messages]
    return "\n".join(["export const MESSAGES = {", *names, "} as const;"]) + "\n"


def _table(declaration: Declaration) -> str:
    lines = [
        "export const TABLE = new Table([",
        *(line for group in declaration.groups for line in _group(group)),
        "]);",
    ]
    return "\n".join(lines) + "\n"


def _group(group: Group) -> list[str]:
    lines = [f"  [{_text(group.name)}, {group.count}, ["]
    for p in group.parameters:
        below = _text(p.below) if p.below else "null"
        lines.append(
            f"    [{_text(p.name)}, {_text(p.kind)}, {_text(p.unit)}, {p.lsb}, {p.minimum}, {p.maximum}, "
            f"{json.dumps(list(p.defaults))}, {json.dumps(p.nonzero)}, {below}, {_text(p.description)}],"
        )
    since = f", {group.since}" if group.since > 1 else ""
    return [*lines, f"  ]{since}],"]
