"""Times the steps of applying a set on the simulated board, motors off.

A step begins in the first 300 us of a tick's time (tick_budget.h). Some take longer than what is left of it and delay
the next tick, which is not counted as late. But the main loop serves nothing else meanwhile, so no step may take three
ticks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from greywhale.protocol import frames, schema
from tools.gates.timing.image import PERIOD, Target
from tools.gates.timing.listing import read_program
from tools.gates.timing.measure import Session, parameters
from tools.support.fuzzy_search import Random

LIMIT = 3 * PERIOD
STEPS = ("crc", "consistency", "joint 0", "joint 1", "joint 2", "joint 3", "finish")  # ParameterSets::work_on_apply
STEP_FUNCTION = "app::LinkServer::apply"  # does a step, and answers after the last
SETS, SEED = 6, 5


@dataclass(frozen=True)
class Applied:
    """The cost of applying some sets."""

    cycles: dict[str, int]  # step -> the most that it has taken, interrupts included
    late_ticks: int  # that were counted

    @property
    def longest(self) -> str:
        """The step that has taken the most cycles."""
        return max(self.cycles, key=lambda step: self.cycles[step])


def apply_sets(target: Target, crc: Callable[[Sequence[int]], int] = schema.param_crc) -> Applied:
    """Applies the defaults and sets drawn by chance; `crc` is that of the image's table with these values."""
    session, draw = Session(target, SEED), Random(SEED)
    step_function = read_program(target.elf).entry(STEP_FUNCTION)
    cycles = dict.fromkeys(STEPS, 0)
    for number in range(SETS):
        values = session.stage(parameters(draw) if number else {})
        request = schema.ParamApplyRequest(crc(values))
        session.board.uart_send(frames.encode_frame(request.TYPE, 1, request.pack()))
        for step in STEPS:
            start = session.run_to(step_function)
            cycles[step] = max(cycles[step], session.end_of_call(step_function) - start)
        session.wait(10)  # for the answer
    return Applied(cycles, session.status().late_ticks)


def complaints(applied: Applied) -> list[str]:
    """One sentence for each step that takes too long, and for ticks that were late."""
    found = [
        f"the step `{step}` of applying a set takes {cycles} cycles, but {LIMIT} is the limit; make two steps of it."
        for step, cycles in applied.cycles.items()
        if cycles > LIMIT
    ]
    if applied.late_ticks:
        found.append(
            f"applying {SETS} sets has made {applied.late_ticks} ticks late; the longest step, `{applied.longest}`, "
            f"takes {applied.cycles[applied.longest]} cycles, and a tick has {PERIOD}: make two steps of it."
        )
    return found
