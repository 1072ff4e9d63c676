"""Writes the C++ header of the numbers that go over the link; it depends on nothing, so every room may use it."""

from __future__ import annotations

from . import NOTICE
from .declaration import Declaration, Enum


def header(declaration: Declaration) -> str:
    """Text of codes/codes.h."""
    parts = [
        f"// Numbers with a name that go over the link.\n// {NOTICE}\n#pragma once\n",
        "#include <stdint.h>\n",
        "namespace codes {\n",
        *(_enum(enum) for enum in declaration.enums),
        "}  // namespace codes",
    ]
    return "\n".join(parts) + "\n"


def _enum(enum: Enum) -> str:
    lines = [f"// {enum.description}", f"enum class {enum.name} : uint8_t {{"]
    lines += [f"  {value.name} = {value.value},  // {value.description}" for value in enum.values]
    return "\n".join([*lines, "};"]) + "\n"
