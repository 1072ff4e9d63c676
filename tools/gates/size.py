"""Checks the memory that a firmware image takes of the chip, and what it must not contain; reads the ELF."""

from __future__ import annotations

import re
from pathlib import Path

from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection

FLASH_LIMIT = 29 * 1024  # of the Nano's 32, less the largest bootloader and room for a repair
RAM_LIMIT = 1800  # before the stack, whose bound on the Nano is below the rest of its 2,048
FLASH_SECTIONS = (".text", ".data")
RAM_SECTIONS = (".data", ".bss", ".noinit")
FORBIDDEN = {
    "floating point": re.compile(
        r"^(__(add|sub|mul|div|neg|cmp|eq|ne|lt|le|gt|ge|unord)[sd]f\d?|__fix(uns)?[sd]f[sd]i|__float(un)?s?[sd]i[sd]f|__fp_\w+)$"
    ),
    "a heap": re.compile(r"^(malloc|calloc|realloc|free|_Zn[wa]j|_Zd[la]Pvj?)$"),
}


def taken(elf: Path) -> tuple[int, int]:
    """Bytes of flash and of RAM."""
    with elf.open("rb") as stream:
        sizes = {section.name: int(section["sh_size"]) for section in ELFFile(stream).iter_sections()}
    flash, ram = (sum(sizes.get(name, 0) for name in names) for names in (FLASH_SECTIONS, RAM_SECTIONS))
    return flash, ram


def complaints(elf: Path) -> list[str]:
    """One sentence for each bound that the image breaks."""
    limits = zip(("flash", "RAM"), taken(elf), (FLASH_LIMIT, RAM_LIMIT), strict=True)
    found = [f"{size} bytes of {what}, but {limit} is the limit." for what, size, limit in limits if size > limit]
    with elf.open("rb") as stream:
        tables = [table for table in ELFFile(stream).iter_sections() if isinstance(table, SymbolTableSection)]
        names = sorted({symbol.name for table in tables for symbol in table.iter_symbols()})
    return found + [
        f"{name}: {what} is linked in." for name in names for what, one in FORBIDDEN.items() if one.match(name)
    ]
