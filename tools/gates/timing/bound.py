"""The longest that a function can run: the dearest flow through its graph that keeps the loop bounds and other facts.

This is implicit path enumeration: how often each edge is taken is an integer unknown of a linear programme. A call
costs what its callee's own bound says.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_matrix

from tools.gates.timing import loops
from tools.gates.timing.cycles import Chip
from tools.gates.timing.facts import Facts
from tools.gates.timing.graph import Graph, build
from tools.gates.timing.listing import ImageError, Program

Counts = NDArray[np.float64]
OFTEN = 10_000  # more often than anything runs in a function


class Flow:
    """The unknowns and equations of one function: a column for each edge and each return."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.ends = sorted(graph.exits)
        self.columns = len(graph.edges) + len(self.ends)
        self.rows: list[tuple[dict[int, float], float, float]] = []
        self._into: dict[int, list[int]] = {node: [] for node in graph.nodes}
        self._out: dict[int, list[int]] = {node: [] for node in graph.nodes}
        for column, edge in enumerate(graph.edges):
            self._into[edge.end].append(column)
            self._out[edge.start].append(column)
        for column, end in enumerate(self.ends, len(graph.edges)):
            self._out[end].append(column)
        for node in graph.nodes:
            terms: dict[int, float] = {}
            for column in self._out[node]:
                terms[column] = terms.get(column, 0) + 1
            for column in self._into[node]:
                terms[column] = terms.get(column, 0) - 1
            once = 1.0 if node == graph.entry else 0.0
            self.rows.append((terms, once, once))

    def runs(self, node: int) -> dict[int, float]:
        """The number of runs of an instruction, as a sum of unknowns."""
        return dict.fromkeys(self._out[node], 1.0)

    def bound_loop(self, loop: loops.Loop, times: int) -> None:
        """A head runs at most `times` for each entry from outside; without a single head every instruction does."""
        heads = loop.heads | ({self.graph.entry} if loop.entered else frozenset())
        entries = [self.graph.edges.index(edge) for edge in loop.entries]
        for node in heads if len(heads) == 1 else loop.nodes:
            terms = self.runs(node)
            for column in entries:
                terms[column] = terms.get(column, 0) - times
            self.rows.append((terms, -math.inf, times if loop.entered else 0))

    def keep_apart(self, groups: list[list[int]]) -> None:
        """Of these groups of instructions, only one runs in a run of the function."""
        switches = list(range(self.columns, self.columns + len(groups)))
        self.columns += len(groups)
        for nodes, switch in zip(groups, switches, strict=True):
            for node in nodes:
                self.rows.append((self.runs(node) | {switch: -OFTEN}, -math.inf, 0))
        self.rows.append((dict.fromkeys(switches, 1.0), -math.inf, 1))

    def dearest(self, prices: Counts) -> Counts:
        """The counts of all columns that make the flow the dearest."""
        cells = [(i, *term) for i, (terms, _, _) in enumerate(self.rows) for term in terms.items()]
        lines, columns, factors = zip(*cells, strict=True)
        matrix = csr_matrix((factors, (lines, columns)), shape=(len(self.rows), self.columns))
        low, high = [row[1] for row in self.rows], [row[2] for row in self.rows]
        wanted = np.zeros(self.columns)
        wanted[: len(prices)] = -prices
        found = milp(
            wanted,
            constraints=LinearConstraint(matrix, low, high),
            integrality=np.ones(self.columns),
            bounds=Bounds(0, OFTEN),
        )
        if found.x is None:
            raise ImageError(f"no flow through {self.graph.entry:#x}: {found.message}")
        counts: Counts = np.rint(found.x)
        return counts


class Timing:
    """Bounds of the functions of one image, each worked out once."""

    def __init__(self, program: Program, chip: Chip, facts: Facts) -> None:
        self.program, self.chip, self.facts = program, chip, facts
        self.graphs: dict[int, Graph] = {}
        self._known: dict[int, int] = {}
        self._open: list[int] = []

    def of(self, entry: int) -> int:
        """The bound of the function at `entry` in cycles, from its first instruction to the end of its return."""
        if entry in self._open:
            names = " -> ".join(self.program.name(address) for address in [*self._open, entry])
            raise ImageError(f"{names}: recursion, so the time has no bound.")
        self._open.append(entry)
        if entry not in self._known:
            self.graphs[entry] = build(self.program, entry, self.chip)
            self._known[entry] = self._solve(self.graphs[entry])
        self._open.pop()
        return self._known[entry]

    def _solve(self, graph: Graph) -> int:
        flow, found = Flow(graph), loops.find(graph)
        name = self.program.name(graph.entry)
        for loop, times in zip(found, self.facts.times(name, self._described(found)), strict=True):
            flow.bound_loop(loop, times)
        for groups in self.facts.apart(name):
            flow.keep_apart([list(self._meant(what, graph)) for what in groups])
        called = {at: self.of(callee) for at, callee in graph.calls.items()}
        prices = [edge.cycles + called.get(edge.start, 0) for edge in graph.edges]
        prices += [graph.exits[end] for end in flow.ends]
        counts = flow.dearest(np.array(prices, dtype=float))
        return int(np.dot(counts[: len(prices)], prices))

    def _described(self, found: list[loops.Loop]) -> list[str]:
        return [f"{self.program.symbol(loop.address)} at {loop.address:#x}" for loop in found]

    def _meant(self, what: str, graph: Graph) -> Iterator[int]:
        """The instructions that a fact speaks of: "call NAME"."""
        kind, _, name = what.partition(" ")
        if kind != "call":
            raise ImageError(f'{what}: a fact speaks of "call NAME".')
        yield from (at for at, callee in graph.calls.items() if self.program.name(callee) == name)
