"""Arms of another engine, with play at their potentiometers, end better than they began, on motions never practised."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.commission.judge import MOST_UNREST
from tools.bench.bench_commission import HUMAN_SHARE, commissioned

pytestmark = pytest.mark.timeout(1800)


@pytest.mark.parametrize("seed", [1, 2])
def test_no_joint_hunts_or_follows_worse_than_before(seed: int, tmp_path: Path) -> None:
    before, after, _ = commissioned(seed, tmp_path)
    for name, was in before.error.items():
        assert (after.error[name] <= 1.02 * was).all(), name
    rests = after.unrest["multi-steps"]
    assert (rests <= np.minimum(MOST_UNREST, np.maximum(2.0 * before.unrest["multi-steps"], 0.0015))).all()
    assert after.error["human reaches"].sum() <= HUMAN_SHARE * before.error["human reaches"].sum()
