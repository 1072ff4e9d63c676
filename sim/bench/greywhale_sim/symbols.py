"""Names of a compiled program: where avr-gcc put its variables and functions."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from elftools.elf.sections import SymbolTableSection

from greywhale._native import BoardError
from greywhale_sim.programs import opened_elf

DATA_BASE = 0x800000  # the data space of avr-gcc's linker begins here; flash begins at 0
EEPROM_BASE = 0x810000


class Symbol(NamedTuple):
    """The place of a name, as Board.peek, poke and call take it: a data address or a flash byte address."""

    address: int
    size: int
    in_flash: bool


def read_symbols(path: str | Path) -> dict[str, Symbol]:
    """All named variables and functions of an ELF program; EEPROM variables are left out."""
    with opened_elf(path) as elf:
        table = elf.get_section_by_name(".symtab")
        if not isinstance(table, SymbolTableSection):
            raise BoardError(f"{path} has no symbol table; link it without --strip-all (-s)")
        entries = [(entry.name, entry["st_value"], entry["st_size"]) for entry in table.iter_symbols()]
    symbols = {}
    for name, value, size in entries:
        if name and value < EEPROM_BASE:
            in_flash = value < DATA_BASE
            symbols[name] = Symbol(value if in_flash else value - DATA_BASE, size, in_flash)
    return symbols
