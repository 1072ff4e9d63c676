"""What a control tick, or an interrupt, must not contain: a software division. What no image may hold: size.py."""

from __future__ import annotations

import re

from tools.gates.timing.cycles import NANO
from tools.gates.timing.graph import build
from tools.gates.timing.listing import ImageError, Program

TICK = "firmware_tick"
DIVISION = re.compile(r"^__(u?div|u?mod|u?divmod)[a-z]*\d?[a-z]*\d?$")


def reachable(program: Program, roots: list[str]) -> dict[str, tuple[str, ...]]:
    """Every symbol that can run below the roots, each with a path to it."""
    paths: dict[str, tuple[str, ...]] = {name: (name,) for name in roots}
    waiting = [(program.symbols[name], paths[name]) for name in roots]
    seen = {entry for entry, _ in waiting}
    while waiting:
        entry, path = waiting.pop()
        graph = build(program, entry, NANO)  # who calls whom is the same on every chip
        for node in graph.nodes:  # jumps may lead into other functions
            paths.setdefault(program.symbol(node), (*path, program.symbol(node)))
        for callee in set(graph.calls.values()) - seen:
            seen.add(callee)
            name = program.symbol(callee)
            paths.setdefault(name, (*path, name))
            waiting.append((callee, paths[name]))
    return paths


def complaints(program: Program) -> list[str]:
    """One sentence for each division."""
    roots = [name for name in program.symbols if name.startswith((TICK, "__vector_"))]
    if not any(name.startswith(TICK) for name in roots):
        raise ImageError(f"{TICK} is not in the image: was the tick renamed or inlined?")
    return [
        f"{' -> '.join(path)}: a software division in the tick."
        for name, path in sorted(reachable(program, roots).items())
        if DIVISION.match(name)
    ]
