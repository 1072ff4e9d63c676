"""A bad line to the real image: a small share of the attacks, and that it would see what it looks for."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.protocol import frames, schema
from greywhale_sim.board_with_image import BoardWithImage
from greywhale_sim.wiring import BOARDS
from tools.attack.damage import DAMAGES, damage
from tools.attack.parts.line import RECOVERY_MS, Session, run


@pytest.mark.slow
@pytest.mark.parametrize("board", BOARDS)
@pytest.mark.parametrize("kind", DAMAGES)
def test_nothing_acts_that_was_not_sent(board: str, kind: str) -> None:
    (row,) = run({"board": board, "kind": kind, "seed": 1, "trials": 40})
    assert row.trials >= 40
    assert row.violations == 0
    assert row.counts["answers"] > 100
    assert row.worst["ms to recover"] <= RECOVERY_MS


@pytest.mark.parametrize("kind", DAMAGES)
def test_each_kind_of_damage_changes_the_bytes_and_is_counted(kind: str) -> None:
    random, data = np.random.default_rng(1), bytes(range(1, 201))
    changed, count = damage(random, data, kind, 0.05)
    assert changed != data
    assert count >= (1 if kind == "a frame broken off" else 5)
    assert damage(random, data, kind, 0.0) == (data, 0)


def test_a_line_that_makes_up_requests_is_seen() -> None:
    """Whole frames with a right CRC that nobody sent: an enable instead of a stop, another value for a parameter."""

    def lie(random: np.random.Generator, data: bytes, kind: str, rate: float) -> tuple[bytes, int]:
        frame = frames.decode_frame(data[:-1])
        assert frame is not None
        if frame.type == schema.StatusRequest.TYPE:
            return frames.encode_frame(schema.EnableRequest.TYPE, frame.seq, b"\x28\0"), 1
        if frame.type == schema.ParamSetRequest.TYPE and frame.payload[0] == 3:
            return frames.encode_frame(frame.type, frame.seq, b"\x04" + frame.payload[1:]), 1
        return data, 0

    session = Session(BoardWithImage("nano"), "a bit flipped", 1, lie)
    session.go_on(0.0)
    assert session.violations > 0
