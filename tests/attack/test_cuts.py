"""Power cuts in a save on the real images: a small share of the attacks, and that it would see what it looks for."""

from __future__ import annotations

import pytest

from greywhale_sim.board_with_image import BoardWithImage
from tools.attack.parts.cuts import cut, cut_a_save, judge, running_crc


@pytest.mark.slow
@pytest.mark.parametrize(("board", "earlier"), [("mega", 0), ("nano", 1), ("mega", 2)])
def test_the_old_set_or_the_new_one_runs_and_a_loss_is_told(board: str, earlier: int) -> None:
    row = cut_a_save(board, earlier, 12, seed=5)
    assert row.violations == 0, row
    assert row.counts["old set, told"] >= 6, "the cuts came in the middle of the save"


def test_a_foreign_set_a_lost_save_and_a_silent_loss_are_seen() -> None:
    bench = BoardWithImage("nano")
    runs = running_crc(bench)
    cut(bench, 1)
    assert judge(bench, runs ^ 1, runs ^ 2, True, False) == "wrong: a set that was never stored runs"
    assert judge(bench, runs, runs ^ 2, True, True) == "wrong: a finished save is lost"
    assert judge(bench, runs, runs ^ 2, True, False) == "wrong: the new set is lost without a word"
    assert judge(bench, runs, runs ^ 2, False, False) == "old set"
    assert judge(bench, runs ^ 1, runs, True, True) == "new set"
