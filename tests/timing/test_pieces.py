"""The main loop's pieces of work on the simulated boards, step by step, against their graphs, facts and bounds."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field

import pytest

from tools.setup.console import ROOT
from tools.timing import busy, delay, facts, loops
from tools.timing.bound import Timing
from tools.timing.graph import Graph
from tools.timing.image import PERIOD, SERVICE, TARGETS, Target, is_described, times
from tools.timing.listing import Program, read_program

pytestmark = pytest.mark.slow
DESCRIBED = [target for target in TARGETS if is_described(target.elf)]
BOARDS = pytest.mark.parametrize("target", DESCRIBED, ids=lambda target: target.chip.name)


@dataclass
class Function:
    """What is known of a function for one of its callers: its graph, and its loops with their facts."""

    name: str
    graph: Graph
    sites: dict[int, int]
    after: dict[int, set[int]]
    loops: list[tuple[loops.Loop, int]]
    limits: list[tuple[set[int], int]]  # these addresses, together, in one run
    by_address: dict[int, list[int]] = field(default_factory=dict)  # address -> its loops


class Image:
    """The functions below App::service, made when a step comes to them."""

    def __init__(self, target: Target) -> None:
        self.program: Program = read_program(target.elf)
        self.known = facts.load()
        self.timing = Timing(self.program, target.chip, self.known)
        self._functions: dict[tuple[int, str, int], Function] = {}

    def function(self, entry: int, caller: str, site: int) -> Function:
        which = (entry, caller, site)
        if which not in self._functions:
            self._functions[which] = self._made(*which)
        return self._functions[which]

    def _made(self, entry: int, caller: str, site: int) -> Function:
        name = self.program.name(entry)
        graph = self.timing.graph(entry)
        key = self.known.key(caller, site, name, self.program.signature(entry))
        found = loops.find(graph)
        after = {node: set(follower) for node, follower in graph.followers().items()}
        limits = []
        for what, most in self.known.limits.get(key, []):
            kind, _, rest = what.partition(" ")
            if kind == "loop":
                limits.append((set(found[int(rest)].heads), most))
            if kind == "call":
                limits.append(({at for at, to in graph.calls.items() if self.program.name(to) == rest}, most))
        bounded = list(zip(found, self.known.times(key, [""] * len(found)), strict=True))
        function = Function(name, graph, graph.sites(), after, bounded, limits)
        for number, loop in enumerate(found):
            for node in loop.nodes:
                function.by_address.setdefault(node, []).append(number)
        return function


class Run:
    """One run of a function: counts its loops."""

    def __init__(self, function: Function) -> None:
        self.function = function
        self.counts: Counter[int] = Counter()
        self.turns = [0] * len(function.loops)
        self.inside: set[int] = set()

    def step(self, address: int) -> None:
        self.counts[address] += 1
        here = self.function.by_address.get(address, [])
        for number in self.inside.difference(here):
            self.turns[number] = 0
        self.inside = set(here)
        for number in here:
            loop, most = self.function.loops[number]
            if address == min(loop.heads):
                self.turns[number] += 1
                assert self.turns[number] <= most, f"{self.function.name}: loop {number}"

    def end(self) -> None:
        for addresses, most in self.function.limits:
            assert sum(self.counts[address] for address in addresses) <= most, self.function.name


def follow(image: Image, passed: list[int], entered: set[str]) -> None:
    """Goes through the calls of a piece as the graphs say. What is not where it may go on belongs to an interrupt."""
    entry = image.program.entry(SERVICE)
    runs, backs = [Run(image.function(entry, "", 1))], [-1]
    allowed, returns, here = {passed[0]}, False, -1
    for address in passed:
        if address not in allowed:
            continue
        here = address
        if returns:
            runs.pop().end()
            backs.pop()
        run = runs[-1]
        graph, returns = run.function.graph, address in run.function.graph.exits
        run.step(address)
        if address in graph.calls:
            callee = graph.calls[address]
            runs.append(Run(image.function(callee, run.function.name, run.function.sites[address])))
            backs.append(image.program.at(address).next)
            entered.add(runs[-1].function.name)
            allowed = {callee}
        else:
            allowed = {backs[-1]} if returns else run.function.after[address]
    assert len(runs) == 1  # it has come to the end, or to where the look ends
    assert returns or here == passed[-1]
    runs[0].end()


@BOARDS
def test_every_piece_keeps_to_its_graph_its_facts_and_its_bound(target: Target) -> None:
    image, bounds = Image(target), times(target).pieces
    dearest: dict[str, int] = {}
    entered: set[str] = set()
    seen: set[tuple[int, ...]] = set()
    for name, cycles, passed in busy.Busy(target, seed=3).day():
        assert cycles <= bounds[name], name
        dearest[name] = max(dearest.get(name, 0), cycles)
        if (way := tuple(passed)) not in seen:
            seen.add(way)
            follow(image, passed, entered)
    assert dearest.keys() == bounds.keys()
    assert all(bounds[name] < 3 * cycles for name, cycles in dearest.items())
    assert {"params::first_bad", "params::Sets::apply", "fuzzy_pdi::make_side", "__udivmodsi4"} <= entered


def test_the_bounds_know_when_the_firmware_begins_a_piece() -> None:
    source = (ROOT / "firmware/lib/app/src/requests.cpp").read_text(encoding="utf-8")
    constants = dict(re.findall(r"constexpr uint\d+_t (\w+) = (\d+);", source))
    known, count_us = facts.load().pieces, 4
    assert int(constants["calm_ticks"]) == delay.CALM_TICKS
    assert known["answer"].begins == int(constants["latest_start_us"]) + count_us
    applying = {piece.begins for name, piece in known.items() if name.startswith("apply")}
    assert applying == {int(constants["latest_apply_us"]) + count_us}
    assert known["request"].reads == int(constants["bytes_per_piece"])


@BOARDS
def test_on_a_quiet_line_with_the_motors_on_no_tick_is_late(target: Target) -> None:
    found, known = times(target), facts.load()
    works = delay.works(found, known.pieces, delay.QUIET)
    late = {name for name, work in works.items() if (delay.end_of_tick(found, work, delay.QUIET) or 0) > PERIOD}
    assert "late look, request" in works, "whatever has delayed a tick, it ends"
    motors_off = {"apply: rules", "apply: end"}
    assert late - {"flood, request"} == motors_off  # bytes are lost on a line that is not quiet
