"""The call graph of an AVR image with each function's use of the stack, read from avr-objdump's disassembly."""

from __future__ import annotations

import re
import subprocess
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

FUNCTION = re.compile(r"^([0-9a-f]{8}) <(.+)>:$")
INSTRUCTION = re.compile(r"^\s+([0-9a-f]+):\t(?:[0-9a-f]{2} )+\s*\t(\S+)\s*([^;]*)(?:;\s*0x([0-9a-f]+))?")
CALLS = {"call", "rcall"}
JUMPS = {"jmp", "rjmp"}
BRANCHES = {
    "brcc", "brcs", "breq", "brge", "brhc", "brhs", "brid", "brie", "brlo",
    "brlt", "brmi", "brne", "brpl", "brsh", "brtc", "brts", "brvc", "brvs",
}  # fmt: skip
ENDS = {"ret", "reti", "jmp", "rjmp", "ijmp", "eijmp"}
NOWHERE = "?"  # only nonsense disassembled from tables leads there
STACK_POINTER_LOW = 0x3D
# Jumps through a table of the calling function's own cases: they stay inside it.
TABLE_JUMP = "__tablejump2__"


class GateError(Exception):
    """The image holds something that the gate cannot judge."""


@dataclass
class Function:
    """What one function does to the stack, and whom it enters. `enables` says it sets the interrupt flag by sei."""

    name: str
    pushes: int = 0
    frame: int = 0
    indirect: bool = False
    enables: bool = False
    calls: set[str] = field(default_factory=set)
    jumps: set[str] = field(default_factory=set)


@dataclass(frozen=True)
class Line:
    address: int
    mnemonic: str
    operands: str
    target: int | None


def _target(address: int, mnemonic: str, operands: str, comment: str | None) -> int | None:
    if mnemonic in ("call", "jmp"):
        return int(operands.split()[0], 16)
    if mnemonic in ("rcall", "rjmp") or mnemonic in BRANCHES:
        return address + 2 + int(operands.strip().split()[0].removeprefix("."))
    return int(comment, 16) if comment else None


def disassemble(elf: Path) -> dict[str, tuple[int, list[Line]]]:
    """Function -> (address, its lines); data tables in flash come out as nonsense that nothing calls."""
    text = subprocess.run(["avr-objdump", "-d", str(elf)], check=True, capture_output=True, text=True).stdout
    functions: dict[str, tuple[int, list[Line]]] = {}
    lines: list[Line] = []
    for row in text.splitlines():
        if head := FUNCTION.match(row):
            lines = []
            functions[head[2]] = (int(head[1], 16), lines)
        elif found := INSTRUCTION.match(row):
            address, mnemonic, operands = int(found[1], 16), found[2], found[3].strip()
            lines.append(Line(address, mnemonic, operands, _target(address, mnemonic, operands, found[4])))
    return functions


def _constant(operands: str) -> int:
    return int(operands.split(",")[1].strip(), 0)


def _frame(lines: list[Line]) -> int:
    """Bytes that a function takes by moving the stack pointer: Y = SP - n, written back."""
    taken = 0
    for index, line in enumerate(lines):
        if line.mnemonic == "in" and line.operands.startswith("r28") and _constant(line.operands) == STACK_POINTER_LOW:
            low = high = 0
            for near in lines[index + 1 : index + 6]:
                if near.mnemonic == "sbiw" and near.operands.startswith("r28"):
                    taken = max(taken, _constant(near.operands))
                elif near.mnemonic == "subi" and near.operands.startswith("r28"):
                    low = _constant(near.operands)
                elif near.mnemonic in ("sbci", "sbc") and near.operands.startswith("r29"):
                    high = _constant(near.operands) if near.mnemonic == "sbci" else 0
            size = (high << 8) + low
            # Adding is subtracting a negative number: the frame's release, not its making.
            taken = max(taken, size if size < 0x8000 else 0)
    return taken


def read_image(elf: Path) -> dict[str, Function]:
    """All functions by name."""
    listing = disassemble(elf)
    order = sorted(listing, key=lambda name: listing[name][0])
    starts = [listing[name][0] for name in order]

    def owner(target: int) -> str:
        place = bisect_right(starts, target)
        return order[place - 1] if place else NOWHERE

    functions = {}
    for place, name in enumerate(order):
        address, lines = listing[name]
        function = Function(name)
        end = starts[place + 1] if place + 1 < len(starts) else (lines[-1].address + 4 if lines else address)
        for line in lines:
            _take(function, line, range(address, end), owner)
        if lines and lines[-1].mnemonic not in ENDS and place + 1 < len(order):
            function.jumps.add(order[place + 1])  # it runs on into the next one
        function.frame += _frame(lines)
        functions[name] = function
    return functions


def _take(function: Function, line: Line, own: range, owner: Callable[[int], str]) -> None:
    if line.target == 0:  # a weak function that is not there (Arduino's serialEventRun), or a restart
        return
    if line.mnemonic == "push":
        function.pushes += 1
    elif line.mnemonic == "sei":
        function.enables = True
    elif line.mnemonic in ("icall", "eicall", "ijmp", "eijmp"):
        function.indirect = True
    elif line.mnemonic in CALLS and line.target is not None:
        if line.target == line.address + 2:  # rcall .+0: takes room (3 bytes at most), enters nobody
            function.frame += 3
        elif line.target == own.start or line.target not in own:
            function.calls.add(owner(line.target))
    elif (line.mnemonic in JUMPS or line.mnemonic in BRANCHES) and line.target is not None and line.target not in own:
        function.jumps.add(owner(line.target))
