"""The tuning as the ablation screens it: on a model identified once, judged on the true arm."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.types import Floats
from greywhale.cli.story.practice import practise, tables
from greywhale.files.arm import load_arm
from greywhale.identify import identify
from greywhale.loop import plant_row
from greywhale.protocol.table import ParameterTable
from greywhale.tune import tune
from greywhale.tune.judge.held_out import HeldOut, judge_held_out
from greywhale.tune.judge.margins import AT_REST, MOVING, Margins
from greywhale.tune.limits import WITHOUT_FLOORS
from greywhale.tune.model import load_model
from tools.benchmarks.ablated import FOLDER, Ablated, true_arm, with_values
from tools.benchmarks.bench_commission import bench_with

BUDGET = int(os.environ.get("GREYWHALE_BUDGET", "300"))
SAMPLES = 1  # the estimate alone, beside the arm with looser gears
MOVED_RAD2 = 1e-5  # a joint with a smaller error hardly moved
USUAL = WITHOUT_FLOORS
GROUPS = ("training", "space", "cost", "floor", "margins", "choice", "following")
# Read by a report or an upload, by a refusal, or by a commissioning only: no tuning's result depends on these.
APART = (
    "training.least_range_rad",
    "floor.backlash_rad2",
    "floor.tellable_rad2",
    "floor.rest_s",
    "floor.rest_rad",
    "floor.waiting_rad",
    "floor.waiting_rad_s",
    "choice.unrest_weight_on_arm",
    "choice.worse_in_report",
    "following.follows_worse",
    "following.unseen_rad",
)
# A rest is longer than what is left out of it.
CLOSER: dict[str, tuple[Any, Any]] = {"margins.settle_s": (0.5, 1.4), "margins.rest_s": (1.6, 4.4)}
# What switches a rule off.
OFF: dict[str, Any] = {
    "model.gear_sigmas": 0.0,
    **dict.fromkeys(("cost.rms_weight", "cost.rattle_weight", "cost.louder_weight", "cost.chatter_weight"), 0.0),
    **dict.fromkeys(("cost.shaking_weight", "cost.effort_weight", "cost.worst_plant_share"), 0.0),
    "cost.least_room_share": 0.0,
    "cost.bearable_share": 1.0,
    "floor.tried_brakes": (1.0,),
    "margins.teeth_damping_divisor": 1.0,
    "margins.long_rest_s": USUAL.margins.rest_s,
    **dict.fromkeys(("margins.search_beyond", "margins.search_ripple_share"), 1.0),
    **dict.fromkeys(("margins.travel_price", "margins.fail_price"), 0.0),
    **dict.fromkeys(("margins.teeth_price", "margins.ripple_price", "margins.loud_price"), 0.0),
    "choice.kept_joint_slack": USUAL.choice.joint_slack,
    "choice.second_chances": 0,
    "choice.gain_reductions": (),
    "choice.same_ripple": 1.0,
    "choice.shaken_ripple": USUAL.choice.same_ripple,
    "following.behind_price": 0.0,
}


def model_of(kind: str, number: int) -> Path:
    """The model file of an arm, identified from practice on its bench where there is none yet."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{kind}_{number}.toml"
    if not path.exists():
        base, white = ParameterTable.defaults(), load_arm("white_box")
        with tempfile.TemporaryDirectory() as name, bench_with(kind, number, Path(name)) as bench:
            logs = practise(bench, white, base, Path(name)).logs
        outcome = identify([logs[0]], white, validate=logs[1:], tables=tables(base))
        if not outcome.complete:
            raise KeyboardInterrupt
        outcome.save(path)
    return path


def tuned(seed: int, kind: str, number: int, values: Mapping[str, Any], budget: int) -> dict[str, float]:
    """The responses of a tuning with these values of limits, all of which are better the smaller they are."""
    limits = with_values(USUAL, values)
    model = load_model(model_of(kind, number), samples=SAMPLES, force=True, judging=limits)
    found = tune(model, budget=budget, seed=seed, threads=1, judging=limits)
    if not found.complete:
        raise KeyboardInterrupt
    arm, judge = _judge(kind, number)
    held_out = judge_held_out(arm, model.table, plant_row(arm), found.before, found.after, 1, USUAL)
    margins = judge.check(found.after)
    rest = [one for one in margins if one.scenario == AT_REST]
    return {
        "error": float(np.mean([np.log(one.after.total_mse / one.before.total_mse) for one in held_out])),
        "worst joint": max(float(ratios_of(one).max()) for one in held_out),
        "ripple": float(np.log(max(one.ripple_v for one in rest))),
        "rattle": float(np.log(max(one.rattle_rad for one in margins if one.scenario == MOVING))),
        "unrest": float(sum(not one.holds for one in margins)),
    }


@cache
def _judge(kind: str, number: int) -> tuple[ArmParameters, Margins]:
    arm = true_arm(kind, number)
    return arm, Margins(arm, ParameterTable.defaults(), plant_row(arm)[None], threads=1)


def ratios_of(one: HeldOut) -> Floats:
    """Logarithms of a joint's error after to before, of those that moved."""
    moved = one.mse_before > MOVED_RAD2
    ratios: Floats = np.log(one.mse_after[moved] / one.mse_before[moved])
    return ratios


TUNE = Ablated(USUAL, GROUPS, APART, CLOSER, OFF, tuned, {"budget": BUDGET}, model_of)
