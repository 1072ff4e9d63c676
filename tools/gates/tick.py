"""Checks that no control tick and no interrupt contains a software division. size.py has what no image may hold."""

from __future__ import annotations

import re

from tools.gates.timing.cycles import NANO
from tools.gates.timing.graph import below
from tools.gates.timing.listing import ImageError, Program

TICK = "firmware_tick"
DIVISION = re.compile(r"^__(u?div|u?mod|u?divmod)[a-z]*\d?[a-z]*\d?$")


def complaints(program: Program) -> list[str]:
    """One sentence for each division."""
    roots = {name: address for name, address in program.symbols.items() if name.startswith(TICK)}
    if not roots:
        raise ImageError(f"{TICK} is not in the image: was the tick renamed or inlined?")
    found = {}
    # Who calls whom is the same on every chip; jumps may lead into other functions.
    for graph, path in below(program, [*roots.values(), *program.vectors.values()], NANO):
        for name in {program.symbol(node) for node in graph.nodes}:
            if DIVISION.match(name):
                found[name] = path if path[-1] == name else (*path, name)
    return [f"{' -> '.join(path)}: a software division in the tick." for _, path in sorted(found.items())]
