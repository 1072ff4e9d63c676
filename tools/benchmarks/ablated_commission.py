"""A commissioning's search on the model as the ablation screens it: from one tuning, judged on the true arm.

What is found is played once, as a round's first trial, which on most arms is the last. Later trials, rounds and the
motions themselves have no part in it.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.base.types import show_no_progress
from greywhale.commission.foresee import foresee
from greywhale.commission.journal import CommissioningJournal
from greywhale.commission.learn import BUDGET
from greywhale.commission.limits import COMMISSIONING_LIMITS
from greywhale.commission.motions import check_motion
from greywhale.commission.search import CheckOnModel
from greywhale.commission.trials import Trials
from greywhale.files import controller
from greywhale.loop import controller_row, plant_row
from greywhale.protocol.firmware import JOINTS
from greywhale.tune import tune
from greywhale.tune.judge.held_out import judge_held_out
from greywhale.tune.limits import BY_THE_ARM, WITHOUT_FLOORS
from greywhale.tune.model import load_model
from greywhale.tune.report.controller_file import save
from tools.benchmarks.ablated import Ablated, true_arm, with_values
from tools.benchmarks.ablated_tune import model_of, ratios_of
from tools.support.simulated_rig import ROOM, SimulatedRig

# At work in later trials only.
APART = ("search.correction_share", "search.least_aim")
USUAL = COMMISSIONING_LIMITS
NEVER = 1e9
# What switches a rule off.
OFF: dict[str, Any] = {
    "search.packs": USUAL.search.packs[:1],
    **dict.fromkeys(("search.worse_gain", "search.unrest_aim", "search.rattle_aim"), 1.0),
    **dict.fromkeys(("search.error_aim", "search.before_aim"), 1.0),
    **dict.fromkeys(("search.worse_lag_s", "search.gear_sigmas", "search.steps_price", "search.least_ki"), 0.0),
    **dict.fromkeys(("search.max_overshoot", "search.retry_error", "search.host_ripple_share"), NEVER),
}


def tuned(kind: str, number: int) -> Path:
    """The controllers that a round tunes on the arm's model, tuned where there are none yet."""
    model = model_of(kind, number)
    path = model.with_name(f"{model.stem}_tuned.toml")
    if not path.exists():
        found = tune(load_model(model, force=True, judging=BY_THE_ARM), budget=BUDGET, threads=1, judging=BY_THE_ARM)
        if not found.complete:
            raise KeyboardInterrupt
        save(found, path)
    return path


def searched(seed: int, kind: str, number: int, values: Mapping[str, Any]) -> dict[str, float]:
    """The responses of a search with these values of limits, from a check with noise by the seed."""
    limits, arm = with_values(USUAL, values), true_arm(kind, number)
    model, found = load_model(model_of(kind, number), force=True), controller.load(tuned(kind, number))
    rig: Any = SimulatedRig(arm, seed=seed)  # in the place of an arm on a port
    with tempfile.TemporaryDirectory() as name, CommissioningJournal(Path(name) / "it", {}, resume=False) as journal:
        trials = Trials(journal, check_motion(ROOM, limits.motion), rig.before, limits)
        before = trials.play_before(lambda: rig)
        begin = time.process_time()
        trials.foresight = foresee(model.arm, rig.before, trials.check, before.traces, before.measured, limits)
        trials.others |= found.other_values()
        on_model = CheckOnModel.of(model, trials, trials.foresight, seed, threads=1)
        rows = on_model.search(controller_row(found), np.ones(JOINTS, dtype=bool), seed, show_no_progress)
        seconds = time.process_time() - begin
        trial = trials.play(lambda: rig, rows)
    held_out = judge_held_out(arm, trial.table, plant_row(arm), before.rows, rows, 1, WITHOUT_FLOORS)
    *steps, hand = (float(np.log(one.after.total_mse / one.before.total_mse)) for one in held_out)
    return {
        "error": hand,
        "error on steps": float(np.mean(steps)),
        "worst joint": max(float(ratios_of(one).max()) for one in held_out),
        "swings": max(one.excess for one in trial.verdicts),
        "faults": float(sum(len(one.faults) for one in trial.verdicts)),
        "seconds": float(np.log(seconds)),
    }


COMMISSION = Ablated(USUAL, ("search",), APART, {}, OFF, searched, prepare=tuned)
