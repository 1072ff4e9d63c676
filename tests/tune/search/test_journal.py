"""A journal brings costs back bit for bit; candidates of another tuning are refused.

What damages and locks it is refused as in every file of checked lines: tests/base/formats/test_checked_lines.py.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.loop import default_controller
from greywhale.tune.search.journal import TuningJournal

ROWS = np.repeat(default_controller()[None], 2, axis=0)
COSTS = np.array([[0.1, 1 / 3, 1e9, 2.0], [5e-324, 0.2, 0.3, 1e300]])
REQUEST: dict[str, Any] = {"seed": 1, "bounds": {}, "pair": (1, 2)}


def written(path: Path, batches: int = 3, request: dict[str, Any] | None = None) -> bytes:
    with TuningJournal(path, request or REQUEST) as book:
        for number in range(batches):
            book.tell(f"stage {number}", ROWS + number, COSTS * (number + 1))
    return path.read_bytes()


def test_costs_come_back_bit_for_bit(tmp_path: Path) -> None:
    path = tmp_path / "j"
    whole = written(path)
    with TuningJournal(path, REQUEST, resume=True) as book:
        for number in range(3):
            assert book.replaying
            costs = book.costs(f"stage {number}", ROWS + number)
            assert costs is not None
            np.testing.assert_array_equal(costs, COSTS * (number + 1))
        assert not book.replaying
        assert book.costs("stage 3", ROWS + 3) is None
    assert path.read_bytes() == whole


def test_other_candidates_than_the_journals_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "j"
    written(path)
    with TuningJournal(path, REQUEST, resume=True) as book:
        book.costs("stage 0", ROWS)
        with pytest.raises(UserError, match=r"batch 2 .*\(stage 1\)"):
            book.costs("stage 1", ROWS)


@pytest.mark.parametrize("cost", [b'"x"', b"[0.5]", b"NaN", b"1e999"])
def test_what_is_no_cost_is_refused(tmp_path: Path, cost: bytes) -> None:
    path = tmp_path / "j"
    path.write_bytes(written(path).replace(b"0.1", cost, 1))
    with pytest.raises(UserError, match="line 2 is not a line"):
        TuningJournal(path, REQUEST, resume=True)
