"""Commissioning an arm that another engine moves, with play at the potentiometers, judged on motions it never saw."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from greywhale.commission.judge import MOST_UNREST
from greywhale.trajectory import human_reaches, multi_steps
from tools.bench.bench_commission import commissioned

SEED = 2
BUDGET, TRIALS = 400, 4  # a small share of the usual effort
HUMAN_SHARE = 0.15


def test_an_arm_of_another_engine_follows_better_and_rests(tmp_path: Path) -> None:
    """Through the serial port, the AVR binary in between."""
    unseen = {"multi-steps": multi_steps(), "human reaches": human_reaches(1, 12.0)}
    before, after, _ = commissioned(SEED, tmp_path, unseen, budget=BUDGET, rounds=1, trials=TRIALS)
    for name in unseen:
        assert np.all(after.error[name] <= before.error[name]), f"no joint follows {name} worse"
    reaches = after.error["human reaches"].sum() / before.error["human reaches"].sum()
    assert reaches <= HUMAN_SHARE
    rests, rested = after.unrest["multi-steps"], before.unrest["multi-steps"]
    assert np.all(rests <= np.minimum(MOST_UNREST, 2.0 * rested))
