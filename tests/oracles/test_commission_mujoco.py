"""Commissioning an arm that another engine moves, with play at the potentiometers, judged on motions it never saw."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.commission.limits import COMMISSIONING_LIMITS
from greywhale.loop import human_reaches, multi_steps
from tools.support.foreign_arm import Commissioned, bench_of, commissioned, foreign_arm

SEED = 2
BUDGET, TRIALS = 400, 2  # a small share of the usual effort
HUMAN_SHARE = 0.15


@pytest.mark.timeout(1800)
def test_an_arm_of_another_engine_follows_better_and_rests(tmp_path: Path) -> None:
    """With the AVR binary in between."""
    unseen = {"multi-steps": multi_steps(), "human reaches": human_reaches(1, 6.0)}
    with bench_of(foreign_arm(SEED), tmp_path) as bench:
        done = commissioned(bench, tmp_path, unseen, budget=BUDGET, trials=TRIALS)
    before, after = done.before, done.after
    # A joint that keeps its controller feels its neighbours' quicker moves.
    most = np.where(done.kept, 1.0 + COMMISSIONING_LIMITS.judge.kept_share, 1.0)
    for name in unseen:
        ratios = after.error[name] / before.error[name]
        assert np.all(ratios <= most), f"a joint follows {name} worse, {ratios} of before; {tried(done)}"
    reaches = after.error["human reaches"].sum() / before.error["human reaches"].sum()
    assert reaches <= HUMAN_SHARE, tried(done)
    rests, rested = after.unrest["multi-steps"], before.unrest["multi-steps"]
    assert np.all(rests <= np.minimum(COMMISSIONING_LIMITS.swings.max_unrest_rad, 2.0 * rested)), tried(done)


def tried(done: Commissioned) -> str:
    """The arm's words about every trial: without them a failure elsewhere could not be understood."""
    trials = (
        f"{one.name} {one.stopped} {[verdict.faults for verdict in one.verdicts]}" for one in done.outcome.trials.done
    )
    return f"kept {done.kept}; {'; '.join(trials)}"
