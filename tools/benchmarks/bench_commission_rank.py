"""Compares how commission's check and a person's reaches rank controllers: Spearman correlations on worn arms.

Each arm is drawn at random, with play at its potentiometers and friction that grows with the load. Its sets are the
controllers from before, those of a short tuning, and variations of these by factors such as commission takes. The
native closed loop plays the bench (docs/closed_loop.md).
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from scipy.stats import spearmanr

from greywhale.arm import ArmParameters
from greywhale.base.study import Task
from greywhale.base.types import Controllers
from greywhale.cli.story.practice import START_POSE_RAD
from greywhale.commission.judge import Limits, judge
from greywhale.commission.measures import Measures, measure
from greywhale.commission.motions import Check, JointRange, check_motion
from greywhale.files.model import arm_toml
from greywhale.fuzzy.settings import GAIN_UNIT
from greywhale.loop import Experiment, default_controller, human_reaches
from greywhale.loop.leader_motions import RANGE_RAD
from greywhale.loop.traces import Traces
from greywhale.protocol.firmware import JOINTS, pwm_steps
from greywhale.protocol.table import CONTROLLER_COLUMNS, ParameterTable
from greywhale.tune import tune
from greywhale.tune.limits import BY_THE_ARM
from greywhale.tune.model import load_model
from greywhale.tune.search.space import largest_ki
from tools.benchmarks.figure import Figure, at_least
from tools.benchmarks.study import repeat, threads
from tools.support.recordings import readings_of, worn_arm

ARMS = range(11, 16)
SETS = 30
BUDGET = 300  # of the tuning
WAIT_S = 1.6
REACHES = (41, 42)  # seeds that nothing else has
# Variations: the largest logarithm of a factor, and the share of joints that keep their controller.
VARIED = {"kp": 0.7, "kd": 0.7, "ki": 1.8, "ku_mv": 0.4}
KEPT = 0.25
ALIKE = 0.9


def sets(arm: ArmParameters, seed: int) -> Iterator[Controllers]:
    """The controllers from before (4, 13), those of a short tuning, and variations of these."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "arm.toml"
        path.write_text(arm_toml(arm, "A worn arm."), encoding="utf-8")
        model = load_model(path, seed=0, force=True)
    tuned = tune(model, budget=BUDGET, threads=threads(), judging=BY_THE_ARM).after
    yield default_controller()
    yield tuned
    random = np.random.default_rng(seed)
    most = {"ki": largest_ki(1) * GAIN_UNIT, "ku_mv": 30_000.0}
    for _ in range(SETS - 2):
        rows = tuned.astype(np.float64)
        for joint in np.flatnonzero(random.random(JOINTS) >= KEPT):
            for name, size in VARIED.items():
                place = joint, CONTROLLER_COLUMNS.index(name)
                rows[place] = min(rows[place] * np.exp(random.uniform(-size, size)), most.get(name, np.inf))
        yield np.rint(rows).astype(np.int32)


def checked(arm: ArmParameters, check: Check, table: ParameterTable, seed: int) -> Measures:
    """The measures that commission takes of a table."""
    experiment = Experiment(check.motion, arm, table=table, seed=seed, wait_s=WAIT_S, resample=True)
    found = experiment.run_exact(every=1)
    shown = readings_of(found.angles[0].astype(np.float64), arm, table, seed)
    volts = found.duties[0] * (arm.drive.supply / np.array(pwm_steps(table.board)))
    return measure(Traces(experiment.leader, shown, volts, WAIT_S), check, table.supply_v)


def led(arm: ArmParameters, table: ParameterTable) -> float:
    """The error (rad²) of led reaches, all joints together."""
    errors = [Experiment(human_reaches(seed), arm, table=table, seed=seed).run_exact().mse.sum() for seed in REACHES]
    return float(np.mean(errors))


def ranked(seed: int) -> dict[str, Any]:
    """The score of each set in the check, and its error in led reaches, both as shares of before."""
    arm, base = worn_arm(seed), ParameterTable.defaults()
    pose, half = np.array(START_POSE_RAD), 0.4 * (RANGE_RAD[:, 1] - RANGE_RAD[:, 0])
    check = check_motion(JointRange(pose, pose - half, pose + half))
    before = checked(arm, check, base, 100 * seed)
    scores, errors = [], []
    for number, rows in enumerate(sets(arm, seed), 1):
        table = base.with_controllers(rows)
        measured = checked(arm, check, table, 100 * seed + number)
        limits = Limits.of(before, (rows == default_controller()).all(axis=1), quiet_v=1.0)
        scores.append(sum(one.share * one.score for one in judge(measured, before, limits, ("",) * JOINTS)))
        errors.append(led(arm, table))
    return {"score": scores, "led": (np.array(errors) / errors[0]).tolist()}


def run() -> list[Figure]:
    found = repeat("commission_rank", [Task(f"worn arm {seed}", ranked, seed) for seed in ARMS])
    figures = []
    for head, facts in found.items():
        score, error = np.array(facts["score"]), np.array(facts["led"])
        alike = float(spearmanr(score, error).statistic)
        chosen, best = float(error[score.argmin()]), float(error.min())
        figures += [
            at_least(f"{head}: rank correlation of check and led reaches", alike, "", ALIKE),
            Figure(f"{head}: led reaches of the set that the check prefers, after / before", chosen, "x"),
            Figure(f"{head}: the same of the tuned set", float(error[1]), "x"),
            Figure(f"{head}: the same of the best set", best, "x"),
        ]
    return figures
