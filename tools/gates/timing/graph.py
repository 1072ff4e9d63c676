"""The control-flow graph of one function: its instructions, which may follow which, and whom it calls."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from tools.gates.timing import tables
from tools.gates.timing.cycles import Chip, cost, skip_cost
from tools.gates.timing.listing import (
    BRANCHES,
    CALLS,
    JUMPS,
    RETURNS,
    SKIPS,
    THROUGH_POINTER,
    ImageError,
    Instruction,
    Program,
)


@dataclass(frozen=True)
class Edge:
    """One way to go on: byte addresses, and the cycles of the first instruction when it goes this way."""

    start: int
    end: int
    cycles: int


@dataclass
class Graph:
    """Instructions that can run from an entry to the returns. Jumps into other functions are followed, calls are not.

    `calls` has the callee's address for each calling instruction, `exits` the cycles of each returning instruction.
    """

    entry: int
    edges: list[Edge] = field(default_factory=list)
    calls: dict[int, int] = field(default_factory=dict)
    exits: dict[int, int] = field(default_factory=dict)
    nodes: set[int] = field(default_factory=set)

    def followers(self) -> Mapping[int, list[int]]:
        after: dict[int, list[int]] = {node: [] for node in self.nodes}
        for edge in self.edges:
            after[edge.start].append(edge.end)
        return after


def _ways(program: Program, instruction: Instruction, chip: Chip) -> list[Edge]:
    here, own = instruction.address, cost(instruction, chip)
    if instruction.mnemonic in JUMPS:
        assert instruction.target is not None
        return [Edge(here, instruction.target, own)]
    if instruction.mnemonic in BRANCHES:
        assert instruction.target is not None
        return [Edge(here, instruction.next, own), Edge(here, instruction.target, own + 1)]
    if instruction.mnemonic in SKIPS:
        skipped = program.at(instruction.next)
        return [Edge(here, skipped.address, own), Edge(here, skipped.next, own + skip_cost(skipped))]
    return [Edge(here, instruction.next, own)]


def enters(instruction: Instruction) -> bool:
    """True if it calls a function: `rcall .+0` only makes room on the stack, and at 0 is the reset."""
    return instruction.mnemonic in CALLS and instruction.target not in (0, instruction.next)


def ends(instruction: Instruction) -> bool:
    """True if nothing of its function comes after it: it returns, or jumps to the reset at 0."""
    return instruction.mnemonic in RETURNS or (instruction.mnemonic in JUMPS and instruction.target == 0)


def is_table_jump(program: Program, instruction: Instruction) -> bool:
    return instruction.mnemonic in JUMPS and instruction.target == program.symbols.get(tables.DISPATCH)


def build(program: Program, entry: int, chip: Chip) -> Graph:
    """The graph of the function at `entry`."""
    graph = Graph(entry)
    before: dict[int, Instruction] = {}
    waiting = [entry]
    while waiting:
        address = waiting.pop()
        if address in graph.nodes:
            continue
        instruction = program.at(address)
        graph.nodes.add(address)
        if instruction.mnemonic in THROUGH_POINTER:
            raise ImageError(f"{program.name(address)} goes through a pointer at {address:#x}; nobody knows where to.")
        if ends(instruction):
            graph.exits[address] = cost(instruction, chip)
            continue
        if enters(instruction):
            assert instruction.target is not None
            graph.calls[address] = instruction.target
        if is_table_jump(program, instruction):
            found = tables.cases(program, address, before)
            dear = cost(instruction, chip) + sum(cost(step, chip) for step in tables.dispatch(program))
            ways = [Edge(address, case, dear) for case in found]
        else:
            ways = _ways(program, instruction, chip)
        graph.edges += ways
        for edge in ways:
            before.setdefault(edge.end, instruction)
            waiting.append(edge.end)
    return graph


def below(program: Program, entries: Iterable[int], chip: Chip) -> Iterator[tuple[Graph, tuple[str, ...]]]:
    """The graphs of functions and of all that they call, each once, and the symbols on a way to it."""
    waiting: list[tuple[int, tuple[str, ...]]] = [(entry, (program.symbol(entry),)) for entry in entries]
    seen = {entry for entry, _ in waiting}
    while waiting:
        entry, path = waiting.pop()
        graph = build(program, entry, chip)
        yield graph, path
        called = set(graph.calls.values()) - seen
        seen |= called
        waiting += [(callee, (*path, program.symbol(callee))) for callee in called]
