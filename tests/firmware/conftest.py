"""The boards that the firmware is built for, and what is done to them again and again."""

from __future__ import annotations

import pytest

from greywhale.protocol import schema
from greywhale_sim.board_with_image import CYCLES_PER_TICK, BoardWithImage
from greywhale_sim.wiring import BOARDS


@pytest.fixture(params=BOARDS)
def bench(request: pytest.FixtureRequest) -> BoardWithImage:
    """The real image on a simulated chip, booted, motors off."""
    return BoardWithImage(request.param)


def enable(bench: BoardWithImage) -> None:
    bench.ask(schema.ClearFaultRequest())
    bench.ask(schema.EnableRequest(0))
    assert bench.motors_on


def apply(bench: BoardWithImage, name: str, raw: int) -> None:
    """Run the defaults with another value of one parameter."""
    bench.apply({name: raw}, fresh=True)
    bench.wait(20)


def ms_until_off(bench: BoardWithImage, step_ms: float = 0.004) -> float:
    """Until the drivers are off and the duty is gone, to a step."""
    begun = bench.board.cycle
    while bench.motors_on or bench.duty() > 0.0:
        bench.wait(step_ms)
        assert bench.board.cycle - begun < 1000 * CYCLES_PER_TICK
    return float((bench.board.cycle - begun) / CYCLES_PER_TICK)
