"""The loops of a graph, nested: strongly connected parts, and again without the ways back to their head."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from tools.gates.timing.graph import Edge, Graph


@dataclass(frozen=True)
class Loop:
    """A loop by the edges that lead into it. With one head, every turn passes the head.

    With several heads (the compiler jumps into its middle) every instruction of it has to be bounded.
    """

    nodes: frozenset[int]
    entries: tuple[Edge, ...]  # from outside; none for a head that is the function's entry
    entered: bool  # the function's entry is a head

    @property
    def heads(self) -> frozenset[int]:
        return frozenset(edge.end for edge in self.entries)

    @property
    def address(self) -> int:
        return min(self.nodes)


def _parts(nodes: Iterable[int], edges: Iterable[Edge]) -> list[frozenset[int]]:
    """Strongly connected parts that hold a cycle."""
    order = sorted(nodes)
    place = {node: i for i, node in enumerate(order)}
    inner = [(place[e.start], place[e.end]) for e in edges if e.start in place and e.end in place]
    if not inner:
        return []
    rows, columns = np.array(inner).T
    matrix = csr_matrix((np.ones(len(inner)), (rows, columns)), shape=(len(order), len(order)))
    _, labels = connected_components(matrix, directed=True, connection="strong")
    parts: dict[int, set[int]] = {}
    for node, label in zip(order, labels, strict=True):
        parts.setdefault(int(label), set()).add(node)
    loops_alone = {order[a] for a, b in inner if a == b}
    return [frozenset(part) for part in parts.values() if len(part) > 1 or part & loops_alone]


def find(graph: Graph) -> list[Loop]:
    """All loops, in the order of their lowest address; an inner loop is one of its own."""
    found: list[Loop] = []
    waiting: list[tuple[frozenset[int], list[Edge]]] = [(frozenset(graph.nodes), graph.edges)]
    while waiting:
        nodes, edges = waiting.pop()
        for part in _parts(nodes, edges):
            entries = tuple(e for e in graph.edges if e.end in part and e.start not in part)
            # Of an inner loop, edges that lead on from the outer head count as entries as well.
            loop = Loop(part, entries, graph.entry in part)
            found.append(loop)
            heads = loop.heads | ({graph.entry} if loop.entered else frozenset())
            if len(heads) == 1:
                inner = [e for e in edges if e.start in part and e.end in part and e.end not in heads]
                waiting.append((part, inner))
    return sorted(found, key=lambda loop: (loop.address, -len(loop.nodes)))
