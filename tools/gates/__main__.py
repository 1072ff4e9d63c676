"""Fails when a firmware image breaks a bound: it must fit the smaller board and hold no heap and no float, its tick
must hold no division and keep to its cycles, as must its interrupts, and its stack must not meet its variables.

python -m tools.gates
"""

from __future__ import annotations

import sys
from pathlib import Path

from tools.gates import size, stack, tick
from tools.gates.timing import budget
from tools.gates.timing.image import TARGETS, Target, compiler, is_described, times
from tools.gates.timing.listing import ImageError, read_program


def check(elf: Path, target: Target) -> list[str]:
    """Complaints about one image; prints its bounds."""
    flash, ram = size.taken(elf)
    print(f"{target.chip.name:12} flash {flash} of {size.FLASH_LIMIT} bytes, RAM {ram} of {size.RAM_LIMIT}")
    found = [*size.complaints(elf), *tick.complaints(read_program(elf))]
    deepest = stack.bound(elf, target.chip)
    print(f"{target.chip.name:12} stack at most {deepest.bytes} bytes of {deepest.free}, in {' > '.join(deepest.path)}")
    if deepest.bytes > deepest.free:
        found.append(f"the stack may take {deepest.bytes} bytes, but variables leave {deepest.free}.")
    if is_described(elf):
        longest = times(target, elf)
        print(f"{target.chip.name:12} tick at most {longest.tick} cycles without its interrupts")
        found += budget.complaints(target.chip.name, longest, budget.load())
    else:
        print(f"{target.chip.name:12} time not bounded: facts.toml does not describe the code of GCC {compiler(elf)}")
    return [f"{target.chip.name}: {complaint}" for complaint in found]


def main() -> int:
    found = []
    for target in TARGETS:
        try:
            found += check(target.elf, target)
        except ImageError as error:
            found.append(f"{target.chip.name}: {error}")
    for complaint in found:
        print(complaint, file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
