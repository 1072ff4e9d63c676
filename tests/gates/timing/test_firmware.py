"""The bounds of the real images against what the simulated boards do, to the cycle."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import pytest

from greywhale.protocol import schema
from tools.gates import stack
from tools.gates.timing import facts, loops
from tools.gates.timing.bound import Timing
from tools.gates.timing.graph import Graph
from tools.gates.timing.image import PERIOD, TICK, Target, built, times
from tools.gates.timing.listing import Program, read_program
from tools.gates.timing.measure import Session, busiest, worst

pytestmark = pytest.mark.slow
# Of another compiler's image facts.toml says nothing: the system's may be any.
DESCRIBED = [target for target in built() if target.is_described()]
BOARDS = pytest.mark.parametrize("target", DESCRIBED, ids=lambda target: target.title)


@dataclass(frozen=True)
class Step:
    """One instruction as it ran, and where the next one was; cycles of both its own and of an interrupt's entry."""

    address: int
    next: int
    cycles: int


@pytest.fixture(scope="module", params=DESCRIBED, ids=lambda target: target.title)
def traced(request: pytest.FixtureRequest) -> tuple[Target, Program, list[Step]]:
    """24 ticks with the motors on, step by step: the line is busy, and pots pass through everything they can do."""
    target: Target = request.param
    session = Session(target, seed=3)
    session.run_set({"tracking_limit": 1, "tracking_ms": 60_000, "filter_shift": 2, "unrest_amplitude": 0})
    session.ask(schema.TelemetryRequest(1))
    return target, read_program(target.elf), list(_trace(session))


def _trace(session: Session) -> Iterator[Step]:
    board = session.board
    for tick in range(24):
        session.disturb()
        if tick % 3 == 0:
            board.uart_send(session.random.bytes(40))
        end = board.cycle + PERIOD
        while board.cycle < end:
            address, start = board.pc, board.cycle
            board.run_until(start + 1)
            yield Step(address, board.pc, board.cycle - start)


def _graphs(program: Program, target: Target) -> dict[int, Graph]:
    """Of the tick, of all interrupts and of what they call."""
    timing = Timing(program, target.chip, facts.load())
    for entry in (program.entry(TICK), *program.vectors.values()):
        timing.of(entry)
    return timing.graphs


def test_every_step_is_in_the_graphs_with_its_cycles(traced: tuple[Target, Program, list[Step]]) -> None:
    target, program, trace = traced
    graphs = _graphs(program, target)
    ways: dict[int, dict[int, int]] = {}
    for graph in graphs.values():
        for edge in graph.edges:
            ways.setdefault(edge.start, {})[edge.end] = edge.cycles
    for graph in graphs.values():
        for at, callee in graph.calls.items():
            ways[at] = {callee: next(iter(ways[at].values()))}
    returns = {at: cycles for graph in graphs.values() for at, cycles in graph.exits.items()}
    handlers, enter = {4 * n for n in target.vectors.values()}, target.chip.interrupt_entry
    seen = 0
    for step in trace:
        if step.address not in ways and step.address not in returns:
            continue
        seen += 1
        if step.next in handlers:  # an interrupt came after it
            own = {returns.get(step.address), *ways.get(step.address, {}).values()}
            assert step.cycles - enter in own, step
        elif step.address in returns:
            assert step.cycles == returns[step.address], step
        else:
            assert ways[step.address].get(step.next) == step.cycles, step
    assert seen > 40_000


def test_no_loop_runs_more_often_than_its_fact_says(traced: tuple[Target, Program, list[Step]]) -> None:
    target, program, trace = traced
    known = facts.load()
    seen = set()
    for entry, graph in _graphs(program, target).items():
        found = loops.find(graph)
        for loop, most in zip(found, known.times(program.name(entry), [""] * len(found)), strict=True):
            (head, *_) = sorted(loop.heads)
            runs, inside = 0, False
            for step in trace:
                if step.address not in graph.nodes:  # an interrupt or a callee in between
                    continue
                inside = inside and step.address in loop.nodes
                runs = (runs if inside else 0) + (step.address == head)
                inside = step.address in loop.nodes
                assert runs <= most, f"{program.name(entry)} at {loop.address:#x}"
                seen |= {(entry, head)} if runs else set()
    assert len(seen) >= 3


@BOARDS
def test_the_dearest_tick_and_interrupts_stay_below_their_bounds(target: Target) -> None:
    found, bounds = worst(target, sets=4), times(target)
    # A pot at a rail keeps its last value, so the dearest paths of a tick exclude each other; the bound adds them up.
    assert found["tick"] <= bounds.tick < 1.5 * found["tick"]
    for role, bound in bounds.interrupts.items():
        assert found[role] <= bound < found[role] + 16, role


@BOARDS
def test_no_tick_of_a_search_is_late_with_both_directions_of_the_line_full(target: Target) -> None:
    assert busiest(target, sets=2) < PERIOD


@BOARDS
def test_the_deepest_stack_stays_below_its_bound(target: Target) -> None:
    session = Session(target, seed=2)
    bound = stack.bound(target.elf, target.chip)
    top = target.chip.ram_end + 1
    # From the reset on: the deepest path is in the start-up.
    session.board.power_on(2)
    session.board.poke(top - bound.free, bytes([0xA5]) * bound.free)
    session.board.run_until(session.board.cycle + 60 * PERIOD)
    session.run_set({"filter_shift": 2})
    session.ask(schema.TelemetryRequest(1))
    session.board.uart_send(session.random.bytes(8000))
    session.board.run_until(session.board.cycle + 120 * PERIOD)
    memory = session.board.peek(top - bound.free, bound.free)
    deepest = bound.free - next(i for i, byte in enumerate(memory) if byte != 0xA5)
    assert deepest <= bound.bytes <= deepest + 32
