"""Finds the targets of a switch that avr-gcc compiled into a table of addresses."""

from __future__ import annotations

from collections.abc import Mapping

from tools.gates.timing.listing import ImageError, Instruction, Program

DISPATCH = "__tablejump2__"  # libgcc: takes the address of a word of the table, goes where it says
REACH = 24  # instructions from the comparison with the number of cases to the jump


def dispatch(program: Program) -> list[Instruction]:
    """The instructions of DISPATCH."""
    steps: list[Instruction] = []
    address = program.symbols[DISPATCH]
    while not steps or steps[-1].mnemonic not in ("ijmp", "eijmp"):
        steps.append(program.at(address))
        address = steps[-1].next
    return steps


def _number(instruction: Instruction) -> int:
    return int(instruction.operands.split(",")[1].strip(), 0)


def cases(program: Program, jump: int, before: Mapping[int, Instruction]) -> list[int]:
    """The addresses that the jump may go to; `before` has an instruction that leads to each address.

    The code in front of the jump compares the case with the number of cases (cpi), moves it to Z if it is not there,
    and adds the table's address, as subi and sbci do with its negative.
    """
    low = high = count = None
    case = "r30"
    at = before.get(jump)
    for _ in range(REACH):
        if at is None:
            break
        if at.mnemonic == "subi" and at.operands.startswith("r30,") and low is None:
            low = _number(at)
        elif at.mnemonic == "sbci" and at.operands.startswith("r31,") and high is None:
            high = _number(at)
        elif at.mnemonic in ("mov", "movw") and at.operands.startswith(f"{case},"):
            case = at.operands.split(",")[1].strip()
        elif at.mnemonic == "cpi" and at.operands.startswith(f"{case},"):
            count = _number(at)
            break
        at = before.get(at.address)
    if low is None or high is None or count is None:
        raise ImageError(f"{program.name(jump)} jumps through a table at {jump:#x} whose size cannot be read.")
    table = 2 * (-(high << 8 | low) & 0xFFFF)
    return sorted({2 * program.word(table + 2 * place) for place in range(count)})
