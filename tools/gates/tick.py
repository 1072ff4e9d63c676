"""What a control tick, or an interrupt, must not contain: floating point, a heap, a software division."""

from __future__ import annotations

import re
from collections.abc import Mapping

from tools.gates.image import Function, GateError

TICK = "firmware_tick"
FORBIDDEN = {
    "a software division": re.compile(r"^__(u?div|u?mod|u?divmod)[a-z]*\d?[a-z]*\d?$"),
    "floating point": re.compile(
        r"^(__(add|sub|mul|div|neg|cmp|eq|ne|lt|le|gt|ge|unord)[sd]f\d?|__fix(uns)?[sd]f[sd]i|__float(un)?s?[sd]i[sd]f|__fp_\w+)$"
    ),
    "a heap": re.compile(r"^(malloc|calloc|realloc|free|_Zn[wa]j|_Zd[la]Pvj?)$"),
}


def reachable(functions: Mapping[str, Function], roots: list[str]) -> dict[str, tuple[str, ...]]:
    """Everything that can run below the roots, each with a path to it."""
    paths: dict[str, tuple[str, ...]] = {name: (name,) for name in roots}
    waiting = list(roots)
    while waiting:
        name = waiting.pop()
        for callee in functions[name].calls | functions[name].jumps:
            if callee not in paths:
                paths[callee] = (*paths[name], callee)
                waiting.append(callee)
    return paths


def complaints(functions: Mapping[str, Function]) -> list[str]:
    """One sentence for each thing that does not belong there."""
    roots = [name for name in functions if name.startswith((TICK, "__vector_"))]
    if not any(name.startswith(TICK) for name in roots):
        raise GateError(f"{TICK} is not in the image: was the tick renamed or inlined?")
    return [
        f"{' -> '.join(path)}: {what} in the tick."
        for name, path in sorted(reachable(functions, roots).items())
        for what, pattern in FORBIDDEN.items()
        if pattern.match(name)
    ]
