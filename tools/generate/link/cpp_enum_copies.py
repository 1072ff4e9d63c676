"""Writes the C++ header that compares other rooms' enums with the link's at compile time."""

from __future__ import annotations

from . import NOTICE
from .declaration import Declaration, Enum


def header(declaration: Declaration) -> str:
    """Text of link/enum_copies.h."""
    return "\n".join([_HEAD, *(_check(enum) for enum in declaration.enums), "}  // namespace wire"]) + "\n"


_HEAD = f"""// Compares an enum of another room with the link's, name by name, at compile time.
// {NOTICE}
//
// Some rooms know nothing of the link but use its names and numbers. For them
//   static_assert(wire::is_copy<room::State>(wire::State()), "states");
// does not compile when the copy lacks a name or has another number. -Wswitch names a value that only the copy has.
#pragma once

#include "link/schema.h"

namespace wire {{

template <class A, class B>
constexpr bool same_number(A a, B b) {{
  return static_cast<uint8_t>(a) == static_cast<uint8_t>(b);
}}
"""


def _check(enum: Enum) -> str:
    names = [value.name for value in enum.values]
    return "\n".join(
        [
            "template <class Copy>",
            f"constexpr bool is_copy({enum.name}, Copy value = Copy()) {{",
            *(f'  static_assert(same_number(Copy::{n}, {enum.name}::{n}), "{enum.name}::{n}");' for n in names),
            "  switch (value) {",
            *(f"    case Copy::{n}:" for n in names),
            "      break;",
            "  }",
            "  return true;",
            "}",
            "",
        ]
    )
