"""What a firmware image takes of the chip, and what it must not contain; read from the ELF."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection

FLASH_LIMIT = 26 * 1024
RAM_LIMIT = 1664

FLASH_SECTIONS = (".text", ".data")
RAM_SECTIONS = (".data", ".bss", ".noinit")

# no heap, no floating point: library functions whose presence gives either away
HEAP = {"malloc", "realloc", "calloc", "free", "_Znwj", "_Znaj"}
FLOAT = {"__addsf3", "__subsf3", "__mulsf3", "__divsf3", "__floatsisf", "__floatunsisf", "__fixsfsi", "__fixunssfsi"}


@dataclass(frozen=True)
class Size:
    flash: int
    ram: int
    forbidden: tuple[str, ...]

    def complaints(self) -> list[str]:
        found = []
        if self.flash > FLASH_LIMIT:
            found.append(f"{self.flash} bytes of flash, but {FLASH_LIMIT} is the limit.")
        if self.ram > RAM_LIMIT:
            found.append(f"{self.ram} bytes of RAM before the stack, but {RAM_LIMIT} is the limit.")
        return [
            *found,
            *(f"{name} is linked in; the firmware has no heap and no float." for name in self.forbidden),
        ]


def measure(elf_path: Path) -> Size:
    with elf_path.open("rb") as stream:
        elf = ELFFile(stream)
        sizes = {section.name: int(section["sh_size"]) for section in elf.iter_sections()}
        tables = (section for section in elf.iter_sections() if isinstance(section, SymbolTableSection))
        names = {symbol.name for table in tables for symbol in table.iter_symbols()}
    return Size(
        flash=sum(sizes.get(name, 0) for name in FLASH_SECTIONS),
        ram=sum(sizes.get(name, 0) for name in RAM_SECTIONS),
        forbidden=tuple(sorted(names & (HEAP | FLOAT))),
    )
