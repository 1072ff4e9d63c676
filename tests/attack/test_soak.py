"""Everything at once on the real images for some seconds, past the end of the tick counter; and what it would see."""

from __future__ import annotations

import pytest

from greywhale.protocol import schema
from greywhale_sim.wiring import BOARDS
from tools.attack.parts import soak
from tools.attack.parts.soak import Soak, run


@pytest.mark.slow
@pytest.mark.parametrize("board", BOARDS)
def test_nothing_is_late_or_lost_while_everything_happens_at_once(board: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(soak, "WRAP_AFTER", 4000)
    (row,) = run({"board": board, "seed": 2, "trials": 20})
    assert row.violations == 0, row
    assert row.counts["wraps"] == 1
    assert min(row.counts[name] for name in ("applied", "saved", "enabled")) > 20
    assert row.counts["samples"] > 15_000


def test_a_sample_that_is_missing_and_a_request_without_an_answer_are_seen() -> None:
    late = Soak("nano", 1)
    late.take(7, 41)
    late.take(9, 43)
    late.bench.board.pc = late.bench.symbols["_exit"].address  # it hangs
    assert late.ask(schema.StatusRequest) == b""
    assert late.counts.lost_samples == 1
    assert late.counts.unanswered == 1
