"""Fails when a firmware image is too large for the smaller board or contains a heap or floating point."""

from __future__ import annotations

import sys

from tools.gates.size import FLASH_LIMIT, RAM_LIMIT, measure_all


def main() -> int:
    sizes = measure_all()
    for size in sizes:
        print(f"{size.board:16} flash {size.flash:6} of {FLASH_LIMIT} bytes   RAM {size.ram:5} of {RAM_LIMIT} bytes")
    complaints = [complaint for size in sizes for complaint in size.complaints()]
    for complaint in complaints:
        print(complaint, file=sys.stderr)
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
