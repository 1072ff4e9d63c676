"""The cycles of each AVR instruction, after the data sheets' instruction set summary (internal memory only)."""

from __future__ import annotations

from dataclasses import dataclass

from tools.gates.timing.listing import BRANCHES, SKIPS, ImageError, Instruction

ONE = """
adc add and andi asr bclr bld bset bst cbr clc clh cli cln clr cls clt clv clz com cp cpc cpi dec eor in inc ldi lsl lsr
mov movw neg nop or ori out rol ror sbc sbci sbr sec seh sei sen ser ses set sev sez sleep sub subi swap tst wdr
"""
TWO = "adiw sbiw mul muls mulsu fmul fmuls fmulsu ld ldd lds st std sts push pop sbi cbi rjmp ijmp eijmp"
THREE = "lpm elpm jmp"
COSTS = {name: cycles for cycles, names in ((1, ONE), (2, TWO), (3, THREE)) for name in names.split()}


@dataclass(frozen=True)
class Chip:
    """Facts that bounds depend on: return addresses of 2 bytes, or 3 with a 22-bit program counter; the end of RAM."""

    name: str
    ram_end: int
    return_address: int

    @property
    def interrupt_entry(self) -> int:
        """Cycles from accepting an interrupt to its jump in the vector table; ending a sleep takes as many more."""
        return 2 + self.return_address


MEGA = Chip("ATmega2560", 0x21FF, 3)
NANO = Chip("ATmega328P", 0x08FF, 2)


def cost(instruction: Instruction, chip: Chip) -> int:
    """Cycles of an instruction that goes on with the next one, or jumps if it always does."""
    mnemonic = instruction.mnemonic
    if mnemonic in BRANCHES or mnemonic in SKIPS:
        return 1
    wide = chip.return_address - 2
    if mnemonic == "call":
        return 4 + wide
    if mnemonic in ("rcall", "icall"):
        return 3 + wide
    if mnemonic == "eicall":
        return 4
    if mnemonic in ("ret", "reti"):
        return 4 + wide
    if mnemonic not in COSTS:
        raise ImageError(f"{mnemonic} at {instruction.address:#x} has no known cost.")
    return COSTS[mnemonic]


def skip_cost(skipped: Instruction) -> int:
    """Cycles that a skip takes more when it skips: one for each word."""
    return skipped.size // 2
