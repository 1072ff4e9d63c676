"""Compiled programs: reads Intel HEX and ELF files and puts them on a simulated board."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from elftools.common.exceptions import ELFError
from elftools.elf.elffile import ELFFile

from greywhale._native import Board, BoardError
from greywhale.board.flash.images import read_pieces

FAMILY_BITS = 0x7F  # of an ELF file's flags


def load_hex(board: Board, path: str | Path, bootloader: bool = False) -> None:
    """Write an Intel HEX file to flash; a bootloader's lowest address becomes the reset vector."""
    board.write_program(read_pieces(Path(path)), str(path), bootloader)


def load_elf(board: Board, path: str | Path) -> None:
    """Write a linked program to flash and EEPROM: all that is to be loaded, at its physical addresses."""
    with opened_elf(path) as elf:
        if (elf["e_machine"], elf["e_type"]) != ("EM_AVR", "ET_EXEC"):
            raise ELFError("it is no linked program for an AVR")
        loaded = [one for one in elf.iter_segments("PT_LOAD") if one["p_filesz"]]
        pieces = [(one["p_paddr"], one.data()) for one in loaded]
        if [len(data) for _, data in pieces] != [one["p_filesz"] for one in loaded]:
            raise ELFError("it ends inside a segment")
        family = elf["e_flags"] & FAMILY_BITS
    if family != board.family:
        raise BoardError(
            f"{path} is built for another chip family (avr{family}), but this board's chip is avr{board.family}; "
            "build it for this chip"
        )
    board.write_program(pieces, str(path))


@contextmanager
def opened_elf(path: str | Path) -> Iterator[ELFFile]:
    """An ELF program; whatever is wrong with it is one sentence."""
    try:
        with Path(path).open("rb") as file:
            yield ELFFile(file)
    except (OSError, ELFError) as error:
        raise BoardError(f"{path} cannot be read as an ELF program ({error}); give the .elf avr-gcc linked") from error
