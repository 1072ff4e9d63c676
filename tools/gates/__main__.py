"""Fails when the tick of a firmware image holds a float, a heap or a division, or its stack may meet its variables.

python -m tools.gates
"""

from __future__ import annotations

import sys
from pathlib import Path

from tools.gates import stack, tick
from tools.gates.image import GateError, read_image

BUILD = Path(__file__).parents[2] / "firmware/.pio/build"
IMAGES = {"megaatmega2560": stack.MEGA, "nanoatmega328": stack.NANO}


def check(elf: Path, chip: stack.Chip) -> list[str]:
    """Complaints about one image; prints its stack bound."""
    found = tick.complaints(read_image(elf))
    bound = stack.bound(elf, chip)
    print(f"{chip.name:12} stack at most {bound.bytes} bytes of {bound.free}, in {' > '.join(bound.path)}")
    if bound.bytes > bound.free:
        found.append(f"the stack may take {bound.bytes} bytes, but variables leave {bound.free}.")
    return [f"{chip.name}: {complaint}" for complaint in found]


def main(build: Path) -> int:
    found = []
    for environment, chip in IMAGES.items():
        try:
            found += check(build / environment / "firmware.elf", chip)
        except GateError as error:
            found.append(f"{chip.name}: {error}")
    for complaint in found:
        print(complaint, file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else BUILD))
