"""Writes the firmware's parameter table: the struct in RAM, its descriptors and defaults in flash."""

from __future__ import annotations

from . import NOTICE
from .cpp_messages import C_TYPES
from .declaration import Declaration, Group, Parameter


def header(declaration: Declaration) -> str:
    """Text of params/table.h."""
    structs: dict[str, Group] = {}
    for group in declaration.groups:
        if group.name:
            structs.setdefault(group.struct, group)
    parts = [
        f"// The parameter table in RAM and its description in flash.\n// {NOTICE}\n#pragma once\n",
        "#include <stddef.h>\n#include <stdint.h>\n",
        "namespace params {\n",
        f"constexpr uint8_t layout = {declaration.layout};\n"
        f"constexpr uint8_t count = {declaration.parameter_count};\n"
        f"constexpr uint8_t field_count = {sum(len(group.parameters) for group in declaration.groups)};\n"
        f"constexpr uint8_t group_count = {len(declaration.groups)};\n",
        "// Packed, so that the bytes in RAM are the bytes on the link and in EEPROM, in the order of the flat index.\n"
        "// Read members by value: a reference to a packed member does not compile.",
        *(_struct(name, group) for name, group in structs.items()),
        _table(declaration),
        f"constexpr uint16_t table_size = {declaration.table_size};",
        "// Of every layout so far: each is the beginning of the next.",
        f"constexpr uint8_t layout_sizes[layout] = {{{', '.join(_layout_sizes(declaration))}}};",
        'static_assert(sizeof(Table) == table_size, "the table must have no padding");\n',
        _DESCRIPTORS,
        "}  // namespace params",
    ]
    return "\n".join(parts) + "\n"


_DESCRIPTORS = """enum class Kind : uint8_t { u8, i8, u16, i16, u32, i32 };

constexpr uint8_t no_field = 0xFF;

struct Field {
  Kind kind;
  uint8_t offset;      // within one element of its group
  uint8_t below;       // field of the same element that must be greater, or no_field
  bool nonzero;
  int32_t minimum;
  int32_t maximum;
};

struct Group {
  uint8_t elements;
  uint8_t fields;
  uint8_t first_field;   // of fields[]
  uint8_t offset;        // of the first element within Table
  uint8_t element_size;
};

extern const Field fields[field_count];      // PROGMEM
extern const Group groups[group_count];      // PROGMEM
extern const Table default_table;            // PROGMEM
"""


def _layout_sizes(declaration: Declaration) -> list[str]:
    return [str(declaration.layout_size(layout)) for layout in range(1, declaration.layout + 1)]


def _comment(parameter: Parameter) -> str:
    lsb = f"{parameter.lsb} " if parameter.lsb != 1 else ""
    return parameter.description + (
        f" [{lsb}{parameter.unit}]" if parameter.unit else f" [{parameter.lsb}]" if lsb else ""
    )


def _struct(name: str, group: Group) -> str:
    lines = [f"struct __attribute__((packed)) {name} {{"]
    lines += [f"  {C_TYPES[p.kind]} {p.name};  // {_comment(p)}" for p in group.parameters]
    return "\n".join([*lines, "};"]) + "\n"


def _table(declaration: Declaration) -> str:
    lines = ["struct __attribute__((packed)) Table {"]
    for group in declaration.groups:
        if group.name:
            lines.append(f"  {group.struct} {group.member}[{group.count}];")
        else:
            lines += [f"  {C_TYPES[p.kind]} {p.name};  // {_comment(p)}" for p in group.parameters]
    return "\n".join([*lines, "};"]) + "\n"


def source(declaration: Declaration) -> str:
    """Text of params/table.cpp."""
    parts = [
        f"// Descriptors and defaults of the parameter table, in flash.\n// {NOTICE}\n",
        '#include "params/table.h"\n\n#include "params/flash.h"\n',
        "namespace params {\n",
        _fields(declaration),
        _groups(declaration),
        _defaults(declaration),
        "}  // namespace params",
    ]
    return "\n".join(parts) + "\n"


def _fields(declaration: Declaration) -> str:
    lines = ["const Field fields[field_count] PROGMEM = {"]
    for group in declaration.groups:
        names = [p.name for p in group.parameters]
        owner = group.struct or "Table"
        for p in group.parameters:
            below = str(names.index(p.below)) if p.below else "no_field"
            nonzero = "true" if p.nonzero else "false"
            lines.append(
                f"    {{Kind::{p.kind}, offsetof({owner}, {p.name}), {below}, {nonzero}, {p.minimum}, {p.maximum}}},"
            )
    return "\n".join([*lines, "};"]) + "\n"


def _groups(declaration: Declaration) -> str:
    lines = ["const Group groups[group_count] PROGMEM = {"]
    first = 0
    for group in declaration.groups:
        place = f"offsetof(Table, {group.member}), sizeof({group.struct})" if group.name else "0, 0"
        lines.append(f"    {{{group.count}, {len(group.parameters)}, {first}, {place}}},")
        first += len(group.parameters)
    return "\n".join([*lines, "};"]) + "\n"


def _defaults(declaration: Declaration) -> str:
    lines = ["const Table default_table PROGMEM = {"]
    for group in declaration.groups:
        rows = [", ".join(str(p.defaults[i]) for p in group.parameters) for i in range(group.count)]
        if group.name:
            lines += ["    {", *(f"        {{{row}}}," for row in rows), "    },"]
        else:
            lines += [f"    {rows[0]},"]
    return "\n".join([*lines, "};"]) + "\n"
