"""Power cuts in a save on the real images: a small share of the attacks."""

from __future__ import annotations

import pytest

from tools.attack.parts.cuts import cut_a_save


@pytest.mark.slow
@pytest.mark.parametrize(("board", "earlier"), [("mega", 0), ("nano", 1), ("mega", 2)])
def test_the_old_set_or_the_new_one_runs_and_a_loss_is_told(board: str, earlier: int) -> None:
    row = cut_a_save(board, earlier, 12, seed=5)
    assert row.violations == 0, row
    assert row.counts["old set, told"] >= 6, "the cuts came in the middle of the save"
