"""Everything at once on the real images for some seconds, past the end of the tick counter."""

from __future__ import annotations

import pytest

from greywhale_sim.wiring import BOARDS
from tools.attack.parts import soak
from tools.attack.parts.soak import run


@pytest.mark.slow
@pytest.mark.parametrize("board", BOARDS)
def test_nothing_is_late_or_lost_while_everything_happens_at_once(board: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(soak, "WRAP_AFTER", 4000)
    (row,) = run({"board": board, "seed": 2, "trials": 20})
    assert row.violations == 0, row
    assert row.counts["wraps"] == 1
    assert min(row.counts[name] for name in ("applied", "saved", "enabled")) > 20
    assert row.counts["samples"] > 15_000
