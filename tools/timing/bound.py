"""The longest that a function can run: the dearest flow through its graph that keeps the loop bounds and other facts.

This is implicit path enumeration: how often each edge is taken is an integer unknown of a linear programme. A call
costs what its callee's own bound says.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_matrix

from tools.timing import loops
from tools.timing.cycles import Chip
from tools.timing.facts import Facts, Part
from tools.timing.graph import Graph, build
from tools.timing.listing import ImageError, Program

Counts = NDArray[np.float64]
OFTEN = 10_000  # more often than anything runs in a function


@dataclass(frozen=True)
class Bound:
    """Cycles of one run at most, return included; how often its instructions run then."""

    cycles: int
    counts: dict[int, int]


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
        """How often an instruction runs, as a sum of unknowns."""
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

    def limit(self, terms: dict[int, float], times: int) -> None:
        """What these unknowns add up to, at most."""
        self.rows.append((terms, -math.inf, times))

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
        self._loops: dict[int, list[loops.Loop]] = {}
        self._known: dict[tuple[str, int, tuple[Part, ...]], Bound] = {}
        self._reached: dict[int, frozenset[str]] = {}
        self._open: list[int] = []

    def graph(self, entry: int) -> Graph:
        if entry not in self.graphs:
            self.graphs[entry] = build(self.program, entry, self.chip)
        return self.graphs[entry]

    def of(self, entry: int, caller: str = "", site: int = 1, never: tuple[Part, ...] = ()) -> Bound:
        """The bound of the function at `entry`, from its first instruction to the end of its return.

        As this one calls it at its nth call, and for the runs in which nothing of `never` happens.
        """
        name = self.program.name(entry)
        if entry in self._open:
            names = " -> ".join(self.program.name(address) for address in [*self._open, entry])
            raise ImageError(f"{names}: recursion, so the time has no bound.")
        self._open.append(entry)
        never = tuple((function or name, what) for function, what in never)
        never = tuple(part for part in never if part[0] in self._below(entry))
        known = (self.facts.key(caller, site, name, self.program.signature(entry)), entry, never)
        if known not in self._known:
            self._known[known] = self._solve(self.graph(entry), known[0], never)
        self._open.pop()
        return self._known[known]

    def _below(self, entry: int) -> frozenset[str]:
        """The names of the function and of all that it calls."""
        if entry not in self._reached:
            self._reached[entry] = frozenset({self.program.name(entry)})  # should it call itself: of() refuses that
            below = (self._below(callee) for callee in set(self.graph(entry).calls.values()))
            self._reached[entry] = self._reached[entry].union(*below)
        return self._reached[entry]

    def _solve(self, graph: Graph, key: str, never: tuple[Part, ...]) -> Bound:
        flow = Flow(graph)
        name = self.program.name(graph.entry)
        if graph.entry not in self._loops:
            self._loops[graph.entry] = loops.find(graph)
        found = self._loops[graph.entry]
        for loop, times in zip(found, self.facts.times(key, self._described(found)), strict=True):
            flow.bound_loop(loop, times)
        for groups in self.facts.apart(key):
            flow.keep_apart([list(self._meant(what, graph, found)) for what in groups])
        nothing = [(what, 0) for function, what in never if function == name]
        for what, times in [*self.facts.limits.get(key, []), *nothing]:
            flow.limit(self._counts(what, flow, found), times)
        sites = graph.sites()
        called = {at: self.of(callee, name, sites[at], never).cycles for at, callee in graph.calls.items()}
        prices = [edge.cycles + called.get(edge.start, 0) for edge in graph.edges]
        prices += [graph.exits[end] for end in flow.ends]
        counts = flow.dearest(np.array(prices, dtype=float))
        cycles = int(np.dot(counts[: len(prices)], prices))
        return Bound(cycles, self._counted(graph, counts))

    @staticmethod
    def _counted(graph: Graph, counts: Counts) -> dict[int, int]:
        often: dict[int, int] = {}
        for edge, count in zip(graph.edges, counts, strict=False):
            often[edge.start] = often.get(edge.start, 0) + int(count)
        for end in graph.exits:
            often.setdefault(end, 1)
        return often

    def _described(self, found: list[loops.Loop]) -> list[str]:
        return [f"{self.program.symbol(loop.address)} at {loop.address:#x}" for loop in found]

    def _meant(self, what: str, graph: Graph, found: list[loops.Loop]) -> Iterator[int]:
        """The instructions that a fact speaks of: "call NAME" or "loop N", N from 0."""
        kind, _, rest = what.partition(" ")
        if kind == "loop":
            yield from found[int(rest)].nodes
        elif kind == "call":
            yield from (at for at, callee in graph.calls.items() if self.program.name(callee) == rest)
        else:
            raise ImageError(f'{what}: a fact speaks of "call NAME" or "loop N".')

    def _counts(self, what: str, flow: Flow, found: list[loops.Loop]) -> dict[int, float]:
        """How often something of a function happens: "call NAME", "loop N" for its head, "entry N" for its entries."""
        kind, _, rest = what.partition(" ")
        if kind == "entry":
            return {flow.graph.edges.index(edge): 1.0 for edge in found[int(rest)].entries}
        nodes = found[int(rest)].heads if kind == "loop" else self._meant(what, flow.graph, found)
        terms: dict[int, float] = {}
        for node in nodes:
            terms |= flow.runs(node)
        if not terms:
            raise ImageError(f"{what}: there is no such thing in {self.program.name(flow.graph.entry)}.")
        return terms
