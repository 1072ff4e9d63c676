"""Fails when a firmware image breaks a bound: it must fit the smaller board and hold no heap and no float, its tick
must hold no division and keep to its cycles, as must its interrupts, its stack must not meet its variables, and to
apply a set must take no step of three ticks.

python -m tools.gates
"""

from __future__ import annotations

import sys

from tools.gates import apply, size, stack, tick
from tools.gates.timing import budget
from tools.gates.timing.image import Target, built, times
from tools.gates.timing.listing import ImageError, read_program


def check(target: Target) -> list[str]:
    """Complaints about one image; prints its bounds."""
    elf, title = target.elf, f"{target.title:22}"
    flash, ram = size.taken(elf)
    print(f"{title} flash {flash} of {size.FLASH_LIMIT} bytes, RAM {ram} of {size.RAM_LIMIT}")
    found = [*size.complaints(elf), *tick.complaints(read_program(elf))]
    deepest = stack.bound(elf, target.chip)
    print(f"{title} stack at most {deepest.bytes} bytes of {deepest.free}, in {' > '.join(deepest.path)}")
    if deepest.bytes > deepest.free:
        found.append(f"the stack may take {deepest.bytes} bytes, but variables leave {deepest.free}.")
    if target.is_described():
        bounds = times(target)
        print(f"{title} tick at most {bounds.tick} cycles without its interrupts")
        found += budget.complaints(target.title, bounds, budget.load())
    else:
        print(f"{title} time not bounded: facts.toml does not describe the code of this compiler")
    applied = apply.apply_sets(target)
    most = applied.cycles[applied.longest]
    print(f"{title} steps of applying a set at most {most} cycles of {apply.LIMIT}, in `{applied.longest}`")
    found += apply.complaints(applied)
    return [f"{target.title}: {complaint}" for complaint in found]


def main() -> int:
    found = []
    for target in built():
        try:
            found += check(target)
        except ImageError as error:
            found.append(f"{target.title}: {error}")
    for complaint in found:
        print(complaint, file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
