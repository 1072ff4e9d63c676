"""The deepest that a firmware's stack can get: every path through every function, and the deepest interrupt on top."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from elftools.elf.elffile import ELFFile

from tools.gates.size import RAM_SECTIONS
from tools.gates.timing import tables
from tools.gates.timing.cycles import Chip
from tools.gates.timing.graph import Graph, below, build
from tools.gates.timing.listing import ImageError, Instruction, Program, read_program

DATA_SPACE = 0x800000
STACK_POINTER_LOW, STACK_POINTER_HIGH = "0x3d", "0x3e"
CONSTRUCTOR = "_GLOBAL__sub_I_"  # __do_global_ctors calls all of them, through a table


@dataclass(frozen=True)
class Bound:
    """Bytes of stack at most, the path that needs them, and the RAM that variables leave."""

    bytes: int
    path: tuple[str, ...]
    free: int


@dataclass(frozen=True)
class Level:
    """Bytes taken since the function began; in Y as well while Y holds a stack pointer that is being worked out."""

    taken: int
    in_y: int | None = None


def _after(level: Level, instruction: Instruction, chip: Chip) -> Level:
    mnemonic, operands = instruction.mnemonic, instruction.operands
    first, _, second = (part.strip() for part in operands.partition(","))
    if mnemonic == "push":
        return Level(level.taken + 1, level.in_y)
    if mnemonic == "pop":
        return Level(level.taken - 1, None if first in ("r28", "r29") else level.in_y)
    if mnemonic in ("call", "rcall") and instruction.target == instruction.next:
        return Level(level.taken + chip.return_address, level.in_y)
    if mnemonic == "in" and first == "r28" and second == STACK_POINTER_LOW:
        return Level(level.taken, level.taken)
    if mnemonic == "out" and first == STACK_POINTER_LOW:
        if second != "r28" or level.in_y is None:
            raise ImageError(f"the stack pointer is set at {instruction.address:#x}, nobody knows to what.")
        return Level(level.in_y, level.in_y)
    if level.in_y is None or first not in ("r28", "r29"):
        return level
    if mnemonic in ("sbiw", "adiw"):
        return Level(level.taken, level.in_y + int(second, 0) * (1 if mnemonic == "sbiw" else -1))
    if mnemonic == "subi" and first == "r28":
        return Level(level.taken, level.in_y + int(second, 0))
    if mnemonic == "sbci" and first == "r29":
        byte = int(second, 0)
        return Level(level.taken, level.in_y + 256 * (byte - 256 if byte > 127 else byte))
    if mnemonic == "sbc" and second == "r1":  # avr-gcc's zero
        return level
    changes_y = mnemonic in ("ldi", "mov", "movw", "add", "adc", "sub", "sbc", "lds", "ldd", "ld", "eor")
    return Level(level.taken, None) if changes_y else level


class Depths:
    """Depth of every function, its own return address not counted."""

    def __init__(self, program: Program, chip: Chip) -> None:
        self._program, self._chip = program, chip
        self._known: dict[int, tuple[int, tuple[str, ...]]] = {}
        self._open: list[int] = []

    def of(self, entry: int) -> tuple[int, tuple[str, ...]]:
        """The depth, and the path that reaches it."""
        if entry in self._known:
            return self._known[entry]
        if entry in self._open:
            names = " -> ".join(self._program.name(address) for address in [*self._open, entry])
            raise ImageError(f"{names}: recursion, so the stack has no bound.")
        self._open.append(entry)
        graph = build(self._program, entry, self._chip)
        levels = self._levels(graph)
        found: tuple[int, tuple[str, ...]] = (max(level.taken for level in levels.values()), ())
        for at, callee in sorted(graph.calls.items()):
            for called in self._called(callee):
                depth, path = self.of(called)
                found = max(found, (levels[at].taken + self._chip.return_address + depth, path))
        self._open.pop()
        self._known[entry] = (found[0], (self._program.name(entry), *found[1]))
        return self._known[entry]

    def _called(self, callee: int) -> list[int]:
        if callee != self._program.symbols.get(tables.DISPATCH):
            return [callee]
        return [address for name, address in self._program.symbols.items() if name.startswith(CONSTRUCTOR)]

    def _levels(self, graph: Graph) -> dict[int, Level]:
        """The depth of the stack before each instruction; it must be one on every path, or there is no bound."""
        after = graph.followers()
        levels = {graph.entry: Level(0)}
        waiting = [graph.entry]
        while waiting:
            address = waiting.pop()
            level = _after(levels[address], self._program.at(address), self._chip)
            for follower in after[address]:
                known = levels.get(follower)
                if known is None:
                    levels[follower] = level
                elif known.taken != level.taken:
                    raise ImageError(f"{self._program.name(follower)}: paths meet at {follower:#x}, stacks unequal.")
                elif known.in_y is not None and known.in_y != level.in_y:
                    levels[follower] = Level(known.taken, None)
                else:
                    continue
                waiting.append(follower)
        return levels


def bound(elf: Path, chip: Chip) -> Bound:
    """The bound of an image that starts at main; interrupts do not nest unless one enables them."""
    program = read_program(elf)
    depths = Depths(program, chip)
    starts = [program.symbols[name] for name in ("main", "__do_global_ctors") if name in program.symbols]
    foreground, path = max(depths.of(start) for start in starts)
    handlers = program.vectors.values()
    for graph, (name, *_) in below(program, handlers, chip):
        if any(program.at(node).mnemonic == "sei" for node in graph.nodes):
            raise ImageError(f"{name}: an interrupt that enables interrupts may nest, so the stack has no bound.")
    extra = max((chip.return_address + depths.of(address)[0] for address in handlers), default=0)
    return Bound(chip.return_address + foreground + extra, path, chip.ram_end + 1 - _variables_end(elf))


def _variables_end(elf: Path) -> int:
    with elf.open("rb") as stream:
        variables = [one for one in ELFFile(stream).iter_sections() if one.name in RAM_SECTIONS and one["sh_size"]]
        return max(int(section["sh_addr"] + section["sh_size"]) for section in variables) - DATA_SPACE
