"""Values and tables as TOML text, so that reading them back gives the same values, floats bit for bit."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from typing import Any

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def value(thing: object) -> str:
    """One value; a mapping becomes an inline table. TypeError for a value that TOML cannot hold, such as None."""
    if isinstance(thing, bool):
        return "true" if thing else "false"
    if isinstance(thing, str):
        # JSON's escapes are TOML's, but for DEL, which TOML wants escaped too.
        return json.dumps(thing, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(thing, int):
        return str(thing)
    if isinstance(thing, float):
        return repr(thing) if math.isfinite(thing) else f"{thing:+}".replace("+nan", "nan")
    if isinstance(thing, Mapping):
        inside = ", ".join(f"{key(name)} = {value(item)}" for name, item in thing.items())
        return f"{{ {inside} }}" if inside else "{}"
    if isinstance(thing, list | tuple):
        return "[" + ", ".join(value(item) for item in thing) + "]"
    raise TypeError(f"{thing!r} has no form in TOML")


def key(name: str) -> str:
    """A key, quoted where it must be."""
    return name if _BARE.fullmatch(name) else value(name)


def table(name: str, content: Mapping[str, Any]) -> list[str]:
    """The lines of [name]: plain values first, then lists of mappings as [[name.key]]."""
    rows = {item: rows for item, rows in content.items() if _is_rows(rows)}
    lines = [f"[{name}]", *(f"{key(item)} = {value(content[item])}" for item in content if item not in rows)]
    for item, tables in rows.items():
        for one in tables:
            lines += ["", f"[[{name}.{key(item)}]]", *(f"{key(cell)} = {value(what)}" for cell, what in one.items())]
    return lines


def _is_rows(thing: object) -> bool:
    return isinstance(thing, list | tuple) and bool(thing) and all(isinstance(one, Mapping) for one in thing)
