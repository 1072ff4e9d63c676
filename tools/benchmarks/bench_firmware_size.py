"""Flash and RAM of the firmware on both boards."""

from __future__ import annotations

from tools.benchmarks.figure import Figure
from tools.gates.size import FLASH_LIMIT, RAM_LIMIT, measure_all


def run() -> list[Figure]:
    figures = []
    for size in measure_all():
        flash = Figure(f"flash, {size.board}", size.flash, "B", f"<= {FLASH_LIMIT}", size.flash <= FLASH_LIMIT)
        ram = Figure(f"RAM, {size.board}", size.ram, "B", f"<= {RAM_LIMIT}", size.ram <= RAM_LIMIT)
        figures += [flash, ram]
    return figures
