"""A leader's jump on the real images while a host keeps the board busy in every fourth tick, as `adapt` does."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.protocol import schema
from greywhale.protocol.frames import encode_frame
from greywhale_sim.board_with_image import BoardWithImage
from tests.firmware.conftest import enable

MILLIVOLTS_A_RAD = 5000.0 / np.deg2rad(300.0)
FASTEST_RAD_S = 4.0  # of a hand, in recordings
WAY_RAD = 0.5
BUSY_MS = 400


def stage(bench: BoardWithImage) -> None:
    """Ask for something that takes the time between two ticks: a parameter of the staged set."""
    request = schema.ParamSetRequest(0, schema.PARAMETERS[0].default)
    bench.board.uart_send(encode_frame(request.TYPE, 7, request.pack()))


def lead(bench: BoardWithImage, angle: float) -> None:
    """Leader and follower together, so that there is no error."""
    bench.board.set_millivolts(bench.millivolts + angle * MILLIVOLTS_A_RAD)


@pytest.mark.slow
@pytest.mark.parametrize("turn", range(4))
def test_a_board_that_is_asked_in_every_fourth_tick_finds_a_jump_and_none_in_a_hands_motion(
    bench: BoardWithImage, turn: int
) -> None:
    bench.ask(schema.TelemetryRequest(1))
    enable(bench)
    bench.wait(150 + turn)
    for phase in np.arange(0.0, 1.0, 0.125):
        bench.wait(phase)
        for ms in range(BUSY_MS):
            if ms % 4 == 0:
                stage(bench)
            lead(bench, WAY_RAD * np.sin(FASTEST_RAD_S / WAY_RAD * ms / 1000))
            bench.wait(1)
        assert bench.motors_on, (phase, bench.status().fault)
    for joint in range(4):
        enable(bench)
        bench.wait(20)
        stage(bench)
        bench.millivolts[joint] += MILLIVOLTS_A_RAD
        lead(bench, 0.0)
        bench.wait(12)
        bench.millivolts[joint] -= MILLIVOLTS_A_RAD
        lead(bench, 0.0)
        assert not bench.motors_on
        bench.wait(30)
